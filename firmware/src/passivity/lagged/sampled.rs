//! Current loops with a whole number of updates per period and linear interpolation between them (theory,
//! section 13.8, equation 51).
//!
//! The rest of a step shrinks by `p = exp(-h / tau)` from update to update, with the interval `h`. Mean and
//! mean square of a straight line from 1 to `p` are `(1 + p) / 2` and `(1 + p + p^2) / 3`, so the geometric
//! series over all updates give the sums below in place of `tau` and `tau / 2` of a continuous lag.

use super::left;
use crate::passivity::interval::Interval;

/// The delay of a number of updates in periods.
pub const fn delay_of_updates(update: u32, updates: u16) -> Interval {
    let whole = update / updates as u32;
    if update == whole * updates as u32 {
        return Interval::exact(whole as f64);
    }
    Interval::exact(update as f64).div(Interval::exact(updates as f64))
}

/// A lag at the updates, with linear interpolation between them.
#[derive(Clone, Copy)]
pub struct SampledLag {
    updates: f64,
    /// `p`, the rest of a step after one update.
    left: Interval,
}

impl SampledLag {
    /// The lag with a time constant in periods and `updates` updates per period.
    #[inline(never)]
    pub const fn of(updates: u16, tau: Interval) -> Self {
        let updates = updates as f64;
        Self { updates, left: left(Interval::ONE.div(Interval::exact(updates)), tau) }
    }

    /// The integral of the rest of a step in periods, `(h / 2) (1 + p) / (1 - p)`. Computed with `p` only
    /// once; it rises with `p`.
    #[inline(never)]
    pub const fn held(&self) -> Interval {
        let sum = Interval::ONE.div(Interval::ONE.sub(self.left));
        sum.sub(Interval::ONE.half()).div(Interval::exact(self.updates))
    }

    /// The same less the integral of its square, `(h / 6) (1 + 4 p + p^2) / (1 - p^2)`: in partial fractions,
    /// each of which rises with `p`.
    pub const fn unspread(&self) -> Interval {
        let near = Interval::exact(3.0).div(Interval::ONE.sub(self.left));
        let far = Interval::ONE.div(Interval::ONE.add(self.left));
        near.sub(far).sub(Interval::ONE).div(Interval::exact(6.0 * self.updates))
    }

    /// The integral of the rest of a step from a time in periods on, which is not negative.
    ///
    /// From the update before that time on the rest is a straight line. Computed for the lower end of the
    /// time: the rest is at most 1.
    #[inline(never)]
    pub const fn held_after(&self, time: Interval) -> Interval {
        let (update, within, beyond) = self.place(time);
        let sunk = Interval::ONE.sub(self.left).mul(within.mul(within)).half();
        let passed = within.sub(sunk).div(Interval::exact(self.updates));
        let held = self.after_updates(update).mul(self.held().sub(passed));
        held.sub(Interval::new(0.0, beyond.hi().max(0.0)))
    }

    /// The integral of its square from a time in periods on, which is not negative: the rest of the straight line
    /// that is on at that time, and the lines after it.
    pub const fn square_after(&self, time: Interval) -> Interval {
        let (update, within, _) = self.place(time);
        let (from, to) = (self.rest_after(time), self.after_updates(update + 1));
        let squares = from.mul(from).add(from.mul(to)).add(to.mul(to));
        let length = Interval::ONE.sub(within).div(Interval::exact(3.0 * self.updates));
        let later = to.mul(to).mul(self.held().sub(self.unspread()));
        squares.mul(length).add(later)
    }

    /// The rest of a step at a time in periods, which is not negative: from one update to the next it falls
    /// by at most 1.
    #[inline(never)]
    pub const fn rest_after(&self, time: Interval) -> Interval {
        let (update, within, beyond) = self.place(time);
        let sunk = Interval::ONE.sub(self.left).mul(within);
        let rest = self.after_updates(update).mul(Interval::ONE.sub(sunk));
        let fall = beyond.mul(Interval::exact(self.updates));
        rest.add(Interval::new(-fall.hi().max(0.0), fall.hi().max(0.0)))
    }

    /// The update before the lower end of a time, the part of an interval from there to it, and the periods
    /// from the end of that part to the upper end.
    const fn place(&self, time: Interval) -> (u32, Interval, Interval) {
        let from = Interval::exact(time.lo().max(0.0)).mul(Interval::exact(self.updates));
        let update = from.lo() as u32;
        let part = from.sub(Interval::exact(update as f64));
        let beyond = Interval::exact((part.hi() - 1.0).max(0.0))
            .div(Interval::exact(self.updates))
            .add(Interval::exact(time.hi()).sub(Interval::exact(time.lo())));
        (update, part.and(Interval::new(0.0, 1.0)), beyond)
    }

    /// The rest of a step after a time in periods that is a whole number of updates.
    #[inline(never)]
    pub const fn after(&self, time: Interval) -> Interval {
        self.after_updates((time.midpoint() * self.updates + 0.5) as u32)
    }

    const fn after_updates(&self, mut updates: u32) -> Interval {
        let (mut power, mut square) = (Interval::ONE, self.left);
        while updates > 0 {
            if updates & 1 == 1 {
                power = power.mul(square);
            }
            square = square.mul(square);
            updates >>= 1;
        }
        power
    }
}
