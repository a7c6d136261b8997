//! Current loops that are updated a whole number of times in a period, with straight lines between the
//! updates (theory, section 13.8, equation 51).
//!
//! What is left of a step shrinks by `p = exp(-h / tau)` from update to update, which are `h` apart. Mean and
//! mean square of a straight line from 1 to `p` are `(1 + p) / 2` and `(1 + p + p^2) / 3`, so that over all
//! updates the geometric series leave the sums below where a continuous lag has `tau` and `tau / 2`.

use super::left;
use crate::passivity::interval::Interval;

/// The delay of so many updates in periods.
pub const fn delay_of_updates(update: u32, updates: u16) -> Interval {
    let whole = update / updates as u32;
    if update == whole * updates as u32 {
        return Interval::exact(whole as f64);
    }
    Interval::exact(update as f64).div(Interval::exact(updates as f64))
}

/// Time between two updates in periods, and what is left of a step after it.
const fn over_an_update(updates: u16, tau: Interval) -> (Interval, Interval) {
    let between = Interval::ONE.div(Interval::exact(updates as f64));
    (between, left(between, tau))
}

/// The integral of what is left of a step in periods, `(h / 2) (1 + p) / (1 - p)`, of a time constant in
/// periods. With `p` once, of which it is a rising function.
pub const fn held_back(updates: u16, tau: Interval) -> Interval {
    let (between, p) = over_an_update(updates, tau);
    let sum = Interval::ONE.div(Interval::ONE.sub(p));
    between.mul(sum.sub(Interval::ONE.half()))
}

/// The same less the integral of its square, `(h / 6) (1 + 4 p + p^2) / (1 - p^2)`: in partial fractions, of
/// which each rises with `p`.
pub(super) const fn unspread(updates: u16, tau: Interval) -> Interval {
    let (between, p) = over_an_update(updates, tau);
    let near = Interval::exact(3.0).div(Interval::ONE.sub(p));
    let far = Interval::ONE.div(Interval::ONE.add(p));
    between.mul(near.sub(far).sub(Interval::ONE)).div(Interval::exact(6.0))
}
