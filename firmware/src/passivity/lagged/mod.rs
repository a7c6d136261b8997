//! Passivity at the device's port with a lagging torque: delays of any length, an amplifier and a sensor of
//! first order (theory, section 13).
//!
//! The port is passive if and only if `delta + Re(H g) >= D abs(H)^2 / (4 delta)` on the circle (equation
//! 38), with `g` the sampled response of hold, amplifier, integrator and sensor, and `D` the part of their
//! response between the samples. Both are rational, so [`super::bernstein`] encloses the whole condition.
//!
//! All times in this module are in periods.

use super::bernstein::{Minimum, Precision, minimum};
use super::chebyshev::{Kernel, Series};
use super::discrete::{RealPart, kernel_of, residues_at_real_points};
use super::interval::Interval;
use super::poles::{
    IndexError, Reduced, UndecidedReason, cancelled_exactly, reduce, zeros_multiplied,
};
use super::polynomial::{Polynomial, UnitRoot};
use super::transfer::Transfer;

mod sampled;

pub use sampled::{SampledLag, delay_of_updates};

/// Delay and lags in periods, as intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagIntervals {
    /// Time from count to torque.
    pub delay: Interval,
    /// Time constants of amplifier and sensor; exactly 0 without a lag.
    pub lags: [Interval; 2],
    /// Updates of the amplifier's current loop per period, 0 if it is continuous. With updates there is no second
    /// lag, and the delay is [a whole number](delay_of_updates) of update intervals, unless it ends between two.
    pub updates: u16,
    /// Whether the delay ends between two updates, as it does from the instant of a reading that is old.
    pub between: bool,
}

/// The sampled response of an ideal device to a held torque, `z^-whole g`, and its ripple between the
/// samples.
///
/// `g = T (bracket(z) / (z^2 lag(z))) z / (z - 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledResponse {
    /// Whole samples of delay.
    whole: i32,
    bracket: Polynomial,
    /// `(z - a)` of each lag.
    lag: Polynomial,
    /// `D abs(lag)^2 / T^2`.
    ripple: Series,
}

/// One lag: its time constant, and the fractions of `held` that remain after a tick and after the rest of a
/// tick; with an exponential, and at the updates of a current loop, of a step as well.
#[derive(Clone, Copy)]
pub(crate) struct Decay {
    pub tau: Interval,
    /// The integral of the rest of a step: the time constant, except with linear interpolation between
    /// updates.
    pub held: Interval,
    /// The same less the integral of its square: half the time constant, except with linear interpolation
    /// between updates.
    pub unspread: Interval,
    pub tick: Interval,
    pub rest: Interval,
    /// The rest of the tick.
    over: Interval,
}

impl Decay {
    pub const NONE: Self = Self {
        tau: Interval::ZERO,
        held: Interval::ZERO,
        unspread: Interval::ZERO,
        tick: Interval::ZERO,
        rest: Interval::ZERO,
        over: Interval::ZERO,
    };

    /// The lag with `over` of a tick left.
    pub const fn of(tau: Interval, over: Interval) -> Self {
        if tau.is_zero() {
            return Self::NONE;
        }
        let (tick, rest) = (left(Interval::ONE, tau), left(over, tau));
        Self { tau, held: tau, unspread: tau.half(), tick, rest, over }
    }

    /// The lag of a current loop with `updates` updates per period, where the rest of the tick is a whole number
    /// of update intervals or, with `between`, any time. Not inlined: continuous lags do not need its frame.
    #[inline(never)]
    pub const fn sampled(tau: Interval, over: Interval, updates: u16, between: bool) -> Self {
        let lag = SampledLag::of(updates, tau);
        let (tick, held) = (lag.after(Interval::ONE), lag.held());
        let rest = if between { lag.held_after(over).div(held) } else { lag.after(over) };
        Self { tau, held, unspread: lag.unspread(), tick, rest, over }
    }

    /// The integral of the square of a step's rest after the tick, where it ends between two updates.
    pub const fn square_left(&self, updates: u16) -> Interval {
        SampledLag::of(updates, self.tau).square_after(self.over)
    }

    /// `(1 - rest) z + (rest - tick)`
    const fn passed(&self) -> Polynomial {
        Polynomial::ascending(&[self.rest.sub(self.tick), Interval::ONE.sub(self.rest)])
    }

    /// `z - tick`
    const fn pole(&self) -> Polynomial {
        Polynomial::ascending(&[self.tick.neg(), Interval::ONE])
    }

    /// `(tau / 2) (1 - tick^2)`
    const fn spread(&self) -> Interval {
        self.unspread.mul(Interval::ONE.sub(self.tick.mul(self.tick)))
    }
}

/// The rest of a step after some time; zero at the lower end if the lag's range begins at 0 and the time is
/// positive.
pub const fn left(time: Interval, tau: Interval) -> Interval {
    let ratio = if tau.is_positive() {
        time.div(tau)
    } else {
        Interval::new(time.div(Interval::exact(tau.hi())).lo(), f64::INFINITY)
    };
    ratio.exp_of_negative()
}

impl LagIntervals {
    /// Number of pieces of the delay's range, each within a sample: at least one.
    pub const fn pieces(&self) -> usize {
        (self.last_whole() - self.first_whole()) as usize + 1
    }

    const fn first_whole(&self) -> i32 {
        self.delay.lo().max(0.0) as i32
    }

    const fn last_whole(&self) -> i32 {
        self.delay.hi().max(0.0) as i32
    }

    /// The response with a delay in one of the pieces.
    ///
    /// `None` if both lags may be zero, but neither certainly is.
    pub const fn response(&self, piece: usize) -> Option<SampledResponse> {
        let whole = self.first_whole() + piece as i32;
        let part = self.delay.sub(Interval::exact(whole as f64));
        let part = part.and(Interval::new(0.0, 1.0));
        let over = Interval::ONE.sub(part);
        let first = match self.updates {
            0 => Decay::of(self.lags[0], over),
            updates => Decay::sampled(self.lags[0], over, updates, self.between),
        };
        let second = Decay::of(self.lags[1], over);
        if first.tau.is_zero() {
            SampledResponse::of(whole, part, second, Decay::NONE)
        } else {
            SampledResponse::of(whole, part, first, second)
        }
    }
}

/// The largest `e (1 - e)` of delays in a range, in periods, with `e` the fraction of a delay beyond its
/// whole samples: no mixture of such responses has more ripple `D / T^2` (equation 45).
pub const fn ripple_of_mixture(least: Interval, most: Interval) -> Interval {
    let quarter = Interval::ONE.half().half();
    // Between two half-integers it falls and rises, so its maximum is at an end or at a half-integer.
    let halves = (most.hi() + 0.5) as i32 as f64 - 0.5;
    if halves >= least.lo() {
        return quarter;
    }
    let (first, last) = (lateness(least), lateness(most));
    let (lo, hi) = (first.lo().max(last.lo()), first.hi().max(last.hi()));
    Interval::new(lo.max(0.0), hi.max(0.0))
}

/// `e (1 - e)` of one delay.
const fn lateness(delay: Interval) -> Interval {
    let whole = delay.lo().max(0.0) as i32;
    let part = delay.sub(Interval::exact(whole as f64));
    part.mul(Interval::ONE.sub(part))
}

impl SampledResponse {
    /// `z^-whole g`, from torque to position, at this period in s.
    pub const fn transfer(&self, period: Interval) -> Transfer {
        let response = Transfer::new(self.bracket, self.lag);
        Transfer { scale: period, shift: -1 - self.whole, ones: -1, ..response }
    }

    /// The same with a different ripple `D / T^2`, for a response without lags.
    pub const fn with_ripple(self, ripple: Interval) -> Self {
        Self { ripple: Series::constant(ripple), ..self }
    }

    /// The response `T z^-(whole + 1 - later) (z / (z - 1) - absorbed / (z^later lag))`, with the ripple that
    /// makes it as large as `T / (z - 1)`; `None` beyond the degrees of a polynomial.
    pub const fn absorbed(
        whole: usize,
        later: usize,
        absorbed: &Polynomial,
        lag: Polynomial,
    ) -> Option<Self> {
        let (Some(all), Some(some)) =
            (lag.shifted_up(later + 1), absorbed.times_unit_root(UnitRoot::Plus, 1))
        else {
            return None;
        };
        let shift = -1 - later as i32;
        let Some(cross) = Series::real_part(Kernel::AtOne, shift, absorbed, &lag) else {
            return None;
        };
        let bracket = all.plus(&some.scaled(Interval::ONE.neg()));
        let ripple = Series::ZERO.minus(&cross).minus(&Series::squared_magnitude(absorbed));
        Some(Self { whole: whole as i32, bracket, lag, ripple })
    }

    /// `D / T^2` at `c = cos(theta)`.
    pub const fn ripple_at(&self, c: f64) -> Interval {
        let c = Interval::exact(c);
        self.ripple.at(c).div(Series::squared_magnitude(&self.lag).at(c))
    }

    /// If there is one lag, it is the first.
    const fn of(whole: i32, part: Interval, first: Decay, second: Decay) -> Option<Self> {
        let rest = Interval::ONE.sub(part);
        let held = Polynomial::ascending(&[part, rest]);
        let lateness = Series::constant(part.mul(rest));
        if first.tau.is_zero() {
            let lag = Polynomial::ascending(&[Interval::ONE]);
            return Some(Self { whole, bracket: held, lag, ripple: lateness });
        }
        let second = if second.tau.is_zero() { None } else { Some(second) };
        let Some((lag, lost)) = lost(first, second) else { return None };
        let Some(bracket) = bracket(&held, &lag, &lost) else { return None };
        // `1 - part + part z`, the conjugate of the held part.
        let Some(early) = Polynomial::ascending(&[rest, part]).times(&lost) else { return None };
        let Some(cross) = Series::real_part(Kernel::AtOne, -1, &early, &lag) else { return None };
        let Some(mut ripple) = lateness.times(&Series::squared_magnitude(&lag)) else {
            return None;
        };
        ripple = ripple.minus(&cross).minus(&Series::squared_magnitude(&lost));
        ripple = match second {
            None => ripple.minus(&Series::constant(first.spread())),
            Some(second) => {
                let (a, b) = (first.spread(), second.spread());
                let spread = Series::squared_magnitude(&second.pole()).scaled(a);
                ripple = ripple.minus(&spread);
                ripple = ripple.minus(&Series::squared_magnitude(&first.pole()).scaled(b));
                // 2 (1 - c) a b
                let both = a.mul(b).double();
                ripple.plus(&Series::linear(both, both.neg()))
            }
        };
        Some(Self { whole, bracket, lag, ripple })
    }
}

/// The product of `(z - a)` over the lags, and the numerator over `z` times this product of the part of the
/// torque that the lags hold back.
const fn lost(first: Decay, second: Option<Decay>) -> Option<(Polynomial, Polynomial)> {
    let Some(second) = second else {
        return Some((first.pole(), first.passed().scaled(first.held)));
    };
    let Some(weights) = weights([first.tau, second.tau]) else { return alike(&first, &second) };
    let one = first.passed().scaled(weights[0]).times(&second.pole());
    let other = second.passed().scaled(weights[1]).times(&first.pole());
    let (Some(one), Some(other)) = (one, other) else { return None };
    let lag = some!(first.pole().times(&second.pole()));
    Some((lag, one.plus(&other)))
}

/// The weight of each lag in the response of both, `tau_1^2 / (tau_1 - tau_2)` and the like; `None` if the
/// two are not known to be different.
pub(crate) const fn weights(lags: [Interval; 2]) -> Option<[Interval; 2]> {
    let [a, b] = lags;
    if a.is_zero() || b.is_zero() {
        return Some([a, b]);
    }
    let apart = a.sub(b);
    if apart.contains(0.0) {
        return None;
    }
    Some([a.mul(a).div(apart), b.mul(b).div(apart.neg())])
}

/// The same for two lags that may be equal: with derivatives with respect to the time constant, between the
/// two values, in place of the differences.
///
/// With `u = tau^2 (1 - rest)`, `v = tau^2 (rest - tick)` and differences `[]` over that of the time
/// constants, the numerator is `[u] z^2 + ([v] - tick_2 [u] + u_2 [tick]) z - (tick_2 [v] - v_2 [tick])`.
const fn alike(first: &Decay, second: &Decay) -> Option<(Polynomial, Polynomial)> {
    let tau =
        Interval::new(first.tau.lo().min(second.tau.lo()), first.tau.hi().max(second.tau.hi()));
    let over = first.over;
    let (tick, rest) = (left(Interval::ONE, tau), left(over, tau));
    let twice = tau.double();
    let du = twice.mul(Interval::ONE.sub(rest)).sub(over.mul(rest));
    let dv = twice.mul(rest.sub(tick)).add(over.mul(rest)).sub(tick);
    let dtick = tick.div(tau.mul(tau));
    let square = second.tau.mul(second.tau);
    let u = square.mul(Interval::ONE.sub(second.rest));
    let v = square.mul(second.rest.sub(second.tick));
    let linear = dv.sub(second.tick.mul(du)).add(u.mul(dtick));
    let constant = v.mul(dtick).sub(second.tick.mul(dv));
    match first.pole().times(&second.pole()) {
        Some(lag) if dtick.is_finite() => {
            Some((lag, Polynomial::ascending(&[constant, linear, du])))
        }
        _ => None,
    }
}

/// `held(z) lag(z) - (z - 1) lost(z)`
const fn bracket(held: &Polynomial, lag: &Polynomial, lost: &Polynomial) -> Option<Polynomial> {
    let (Some(held), Some(lost)) = (held.times(lag), lost.times_unit_root(UnitRoot::Plus, 1))
    else {
        return None;
    };
    Some(held.plus(&lost.scaled(Interval::ONE.neg())))
}

/// A controller with a sampled response: the two parts of equation 38 as series in `c = cos(theta)`.
pub struct Port {
    /// `2 Re(H g) r / scale`.
    real: Series,
    scale: Interval,
    /// `D abs(H)^2 r`.
    ripple: Series,
    /// Common denominator, positive.
    r: Series,
    ends: [Interval; 2],
}

impl Port {
    /// The port of a controller `H` from position to torque; its poles must be inside the circle and `H(1)`
    /// must not be negative (theory, section 13).
    ///
    /// # Errors
    /// If they are not, or if a pole on the circle or a number out of range leaves this undecided.
    #[inline(never)]
    pub const fn new(
        controller: &Transfer,
        response: &SampledResponse,
        period: Interval,
        added_ripple: Interval,
    ) -> Result<Self, IndexError> {
        let h = ok!(stable(controller));
        let out_of_range = IndexError::Undecided(UndecidedReason::OutOfRange);
        let velocity = ok!(lagging(&h, response, period));
        ok!(residues_at_real_points(&velocity));
        let (kernel, shift) = kernel_of(&velocity);
        let (n, d) = (&velocity.numerator, &velocity.denominator);
        let Some(real) = Series::real_part(kernel, shift, n, d) else { return Err(out_of_range) };
        let Some(zeros) = zeros_multiplied(&h) else { return Err(out_of_range) };
        let gain = h.scale.mul(period);
        let squared = Series::squared_magnitude(&zeros).scaled(gain.mul(gain));
        let mut ripple = response.ripple;
        if !added_ripple.is_zero() {
            let lag = Series::squared_magnitude(&response.lag).scaled(added_ripple);
            ripple = ripple.plus(&lag);
        }
        let Some(ripple) = ripple.times(&squared) else { return Err(out_of_range) };
        let (left, right) = (d.at_unit_root(UnitRoot::Minus), d.at_unit_root(UnitRoot::Plus));
        Ok(Self {
            real,
            scale: velocity.scale,
            ripple,
            r: Series::squared_magnitude(d),
            ends: [left.mul(left), right.mul(right)],
        })
    }

    /// Encloses the largest `-Re(H g) + D abs(H)^2 / (4 delta)`: below `delta` if and only if the port
    /// is passive.
    ///
    /// # Errors
    /// If a pole is too near the circle for a bound.
    #[inline(never)]
    pub const fn index_for(
        &self,
        delta: Interval,
        closeness: &Precision,
    ) -> Result<RealPart, IndexError> {
        let quarter = Interval::ONE.div(delta.double().double());
        let p = self.real.scaled(self.scale.half()).minus(&self.ripple.scaled(quarter));
        let Minimum { value, at } = minimum(&p, &self.r, self.ends, closeness);
        if value.is_finite() {
            Ok(RealPart { minimum: value.neg(), cos_theta: at })
        } else {
            Err(IndexError::Undecided(UndecidedReason::PoleNearCircle))
        }
    }

    /// The passivity needed at one `c`: the larger root in `delta` of equation 38 with equality.
    const fn needed_at(&self, c: f64) -> Interval {
        let c = Interval::exact(c);
        let r = self.r.at(c);
        let half = self.real.at(c).mul(self.scale).half().div(r).half();
        let ripple = self.ripple.at(c).div(r);
        let ripple = Interval::new(ripple.lo().max(0.0), ripple.hi().max(0.0));
        let quarter = ripple.half().half();
        half.mul(half).add(quarter).sqrt().sub(half)
    }

    /// Encloses the least passivity with which the port is passive, in N m s/rad (equation 39): the largest
    /// of `needed_at` over the circle. `found` is [`Port::index_for`] of any `delta`.
    ///
    /// The index falls with growing `delta`, so the larger of a `delta` and its index is sufficient. The
    /// damping needed at the place of that index is a better `delta`, as in Newton's method.
    ///
    /// # Errors
    /// If a pole is too near the circle for a bound.
    #[inline(never)]
    pub const fn needed(&self, delta: f64, found: RealPart) -> Result<Interval, IndexError> {
        let (mut delta, mut found) = (delta, found);
        let mut enough = f64::INFINITY;
        let mut least = self.needed_at(1.0).lo().max(self.needed_at(-1.0).lo()).max(0.0);
        let mut round = 0;
        loop {
            let (more, less) = (least, enough);
            enough = enough.min(found.minimum.hi().max(delta));
            least = least.max(self.needed_at(found.cos_theta.midpoint()).lo());
            round += 1;
            let is_stuck = round > 1 && least == more && enough == less;
            if is_stuck || round == ROUNDS || enough <= least + PORT_TOLERANCE * least {
                break;
            }
            delta = least.max(f64::MIN_POSITIVE);
            found = ok!(self.index_for(Interval::exact(delta), &Precision::within(CLOSE)));
        }
        // A margin for values computed elsewhere from slightly different decimals; no verdict depends on it.
        Ok(Interval::new(least - ROOM * least, enough + ROOM * enough))
    }
}

/// Rounds of the search for the needed passivity; with poles near the circle the result stays wider.
const ROUNDS: u32 = 6;
/// Additional width on either side of the enclosure, relative to its magnitude.
const ROOM: f64 = 1e-12;
/// Relative width of the enclosures in the search.
const CLOSE: f64 = 2e-11;
/// Relative width of the result.
const PORT_TOLERANCE: f64 = 2e-10;

/// The controller without exact common factors, if all its poles are inside the circle.
#[inline(never)]
pub(crate) const fn stable(controller: &Transfer) -> Result<Transfer, IndexError> {
    match reduce(controller, false) {
        Ok(Reduced { at_one: false, at_minus_one: false, pair: None, .. }) => {
            Ok(cancelled_exactly(controller))
        }
        Ok(_) => Err(IndexError::Undecided(UndecidedReason::PoleNearCircle)),
        Err(error) => Err(error),
    }
}

/// `H g` from velocity, with its poles separated.
#[inline(never)]
const fn lagging(
    h: &Transfer,
    response: &SampledResponse,
    period: Interval,
) -> Result<Reduced, IndexError> {
    let out_of_range = IndexError::Undecided(UndecidedReason::OutOfRange);
    let Some(numerator) = h.numerator.times(&response.bracket) else { return Err(out_of_range) };
    let Some(denominator) = h.denominator.times(&response.lag) else { return Err(out_of_range) };
    let delayed = Transfer { shift: h.shift - response.whole - 2, numerator, denominator, ..*h };
    reduce(&delayed.from_velocity(period), false)
}

#[cfg(test)]
mod tests;
