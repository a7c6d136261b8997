//! The coupling that absorbs latency and jitter (theory, sections 13.3 to 13.5).
//!
//! A coupling behind which any passive environment, linear or not, is passive with a lagging torque. Its
//! compliances are those of a `ResponseWindow` (equations 40 and 54). Without latency it is the standard coupling
//! `T / (2 delta)`. A delay of `(n + e) T` adds a spring in series for each tick and part of a tick that a
//! torque takes,
//!
//! ```text
//! V = (T / (2 delta)) (1 + 1/z + ... + z^-n + e z^-(n+1)),
//! ```
//!
//! and a lag a decaying series of them. All except the first depend only on past torques: the servo subtracts
//! their deflection from the device's position, and solves the rest as for a spring. Times that deviate from
//! tick to tick, or are known in a range, make all of them softer.
//!
//! Coefficients are rounded, and for that the first spring is a little softer than in the formula, as the
//! proof requires. [`MatchedCoupling::of`] computes both the servo's coefficients and the resulting limit on
//! the environment's index, so that they cannot disagree.

use crate::latency::{Latency, TRAILS};
use crate::number::{Format, Rounding};
use crate::parameter::MAX_DELAY;
use crate::passivity::interval::Interval;
use crate::passivity::polynomial::Polynomial;
use crate::response_window::{Fading, ResponseWindow, with_trails};

/// The effect of a lag in later ticks: `gain` rad/(N m) of the torque before last, and the fraction `decay`
/// of it in each following tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trail {
    /// Deflection in rad/(N m).
    pub gain: f64,
    /// The fraction of it that remains a tick later.
    pub decay: f64,
}

/// The coupling's coefficients as a number format rounds them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchedCoupling {
    /// Compliance in rad/(N m) for the torque of this tick.
    pub compliance: f64,
    /// [Whole samples](Latency::whole_samples) that a torque takes.
    pub whole: usize,
    /// Compliance for each of this many earlier torques.
    pub held: f64,
    /// Compliance for the torque before these.
    pub arriving: f64,
    /// The trails of the lags; with a gain of 0 where there is none. Those of two lags have opposite signs: their
    /// sum is a compliance.
    pub trails: [Trail; TRAILS],
    /// The [error](Self::error) of the compliances of earlier torques in rad/(N m): as each counts at least three
    /// times, more than twice the sum of their magnitudes.
    rounding: f64,
    /// Upper bound on the environment's index in N m s/rad.
    pub limit: Interval,
}

impl MatchedCoupling {
    /// The coupling for a device of this passivity (N m s/rad) at this period (s), and at this longest time
    /// between two updates (s) if updates may be missed.
    ///
    /// `None` if a number is out of range, or if no window of torques exists.
    pub const fn of(
        period: f64,
        worst_period: Option<f64>,
        passivity: f64,
        latency: &Latency,
        format: Format,
    ) -> Option<Self> {
        Self::of_kind::<true>(period, worst_period, passivity, latency, format)
    }

    /// The same; without `UPDATES` there is no coupling, and no code, for an amplifier that is updated
    /// several times in a period.
    #[inline(never)]
    pub(crate) const fn of_kind<const UPDATES: bool>(
        period: f64,
        worst_period: Option<f64>,
        passivity: f64,
        latency: &Latency,
        format: Format,
    ) -> Option<Self> {
        let Some(window) = ResponseWindow::of::<UPDATES>(period, worst_period, latency) else {
            return None;
        };
        let (t, delta) = (Interval::decimal(period), Interval::decimal(passivity));
        let standard = t.div(delta.double());
        let whole = window.whole;
        let held = standard.mul(window.tap(if whole == 0 { 0 } else { 1 }));
        let arriving = standard.mul(window.tap(whole + 1));
        let mut run = Self {
            compliance: 0.0,
            whole,
            held: format.coefficient(held.midpoint(), Rounding::Nearest),
            arriving: format.coefficient(arriving.midpoint(), Rounding::Nearest),
            trails: [Trail { gain: 0.0, decay: 0.0 }; TRAILS],
            rounding: 0.0,
            limit: Interval::ENTIRE,
        };
        each!(i in 0..TRAILS => {
            run.trails[i] = rounded(standard, window.trails[i], format);
        });
        let error = run.error(standard, &window);
        run.rounding = error.hi();
        let first = standard.mul(window.tap(0));
        // Above the formula even without an error, by a last bit. With twice the error the loss is least.
        let least = first.add(error.double()).hi().next_up();
        run.compliance = format.coefficient(least, Rounding::Outward);
        let excess = Interval::exact(run.compliance).sub(first);
        match limit(
            t,
            delta,
            window.width,
            excess,
            &Deviation { moment: error, sum: Interval::ZERO },
        ) {
            Some(limit) => Some(Self { limit, ..run }),
            None => None,
        }
    }

    /// Numerator and denominator of `V(z)` with the rounded coefficients; `None` beyond the degrees of a
    /// polynomial.
    pub const fn transfer(&self) -> Option<(Polynomial, Polynomial)> {
        let mut taps = [Interval::ZERO; MAX_DELAY + 2];
        let last = self.whole + 1;
        if last >= taps.len() {
            return None;
        }
        taps[last] = Interval::exact(self.compliance);
        each!(i in 1..last => {
            taps[i] = Interval::exact(self.held);
        });
        taps[0] = Interval::exact(self.arriving);
        let mut trails = [(Interval::ZERO, Interval::ZERO); TRAILS];
        each!(i in 0..TRAILS => {
            let Trail { gain, decay } = self.trails[i];
            trails[i] = (Interval::exact(gain), Interval::exact(decay));
        });
        let mut out = with_trails(&Polynomial::ascending(&taps), &trails);
        let (_, denominator) = some!(&mut out);
        if denominator.shift_up(last) { out } else { None }
    }

    /// Sum of the magnitudes of all compliances in rad/(N m): the largest deflection for torques of up to 1 N m
    /// each. As those of the formula are not negative, it is the deflection of a torque that stays, which is its
    /// lower end, and at most twice the rounding errors more.
    pub const fn compliance_at_rest(&self) -> Interval {
        let held = Interval::exact(self.held).mul(Interval::exact(self.whole as f64));
        let mut sum = Interval::exact(self.compliance).add(held);
        sum = sum.add(Interval::exact(self.arriving));
        each!(i in 0..TRAILS => {
            let Trail { gain, decay } = self.trails[i];
            let lasts = Interval::ONE.sub(Interval::exact(decay));
            sum = sum.add(Interval::exact(gain).div(lasts));
        });
        sum.add(Interval::new(0.0, self.rounding))
    }

    /// Sum over the taps of `(2 m + 1)` times the rounding error, except the first. Where the window is around
    /// two samples or more, the tap at that sample differs from the others that are held, and this difference
    /// counts as such an error.
    const fn error(&self, standard: Interval, window: &ResponseWindow) -> Interval {
        let mut sum = Interval::ZERO;
        each!(m in 1..=self.whole + 1 => {
            let run = if m > self.whole { self.arriving } else { self.held };
            let error = Interval::exact(run).sub(standard.mul(window.tap(m))).abs();
            sum = sum.add(error.mul(Interval::exact(2.0 * m as f64 + 1.0)));
        });
        let n = self.whole as f64;
        each!(i in 0..TRAILS => {
            let (gain, decay) = window.trails[i];
            let run = self.trails[i];
            let gain = standard.mul(gain);
            if !gain.is_zero() {
                let first = Interval::exact(run.gain).sub(gain).abs();
                let later = Interval::exact(run.decay).sub(decay).abs();
                let slowest = Interval::exact(run.decay).max(decay);
                sum = sum.add(moments(n, slowest, first, gain.abs().mul(later)));
            }
        });
        sum
    }
}

/// `sum (2 n + 3 + 2 j) (first a^(j-1) + later (j - 1) a^(j-2))` over `j >= 1`.
const fn moments(n: f64, a: Interval, first: Interval, later: Interval) -> Interval {
    let rest = Interval::ONE.div(Interval::ONE.sub(a));
    let two = Interval::exact(2.0);
    let at_once = Interval::exact(2.0 * n + 3.0).add(two.mul(rest)).mul(rest);
    let growing = Interval::exact(2.0 * n + 5.0)
        .add(two.mul(Interval::ONE.add(a)).mul(rest))
        .mul(rest)
        .mul(rest);
    first.mul(at_once).add(later.mul(growing))
}

const fn rounded(standard: Interval, trail: Fading, format: Format) -> Trail {
    let (gain, decay) = trail;
    Trail {
        gain: format.coefficient(standard.mul(gain).midpoint(), Rounding::Nearest),
        decay: format.coefficient(decay.midpoint(), Rounding::Nearest),
    }
}

/// The deviations `e_m`, `m >= 1`, of a coupling from the formula.
#[derive(Clone, Copy)]
struct Deviation {
    /// `sum (2 m + 1) abs(e_m)` in rad/(N m).
    moment: Interval,
    /// A number from 0 to `sum abs(e_m)`.
    sum: Interval,
}

/// The upper bound on an index behind a coupling with an `excess` of the first spring over the formula of a
/// window of this `width`, and with these deviations of the others (equation 41); `None` if that coupling is
/// not known to be passive.
const fn limit(
    t: Interval,
    delta: Interval,
    width: Interval,
    excess: Interval,
    others: &Deviation,
) -> Option<Interval> {
    let margin = excess.sub(others.moment);
    if !margin.is_positive() || !delta.is_positive() {
        let is_exact = excess.is_zero() && others.moment.is_zero();
        return if is_exact { Some(delta.div(width)) } else { None };
    }
    let most = excess.sub(others.sum);
    let loss = delta.double().mul(most).mul(most).div(t.mul(margin));
    Some(delta.div(width.add(loss)))
}

/// The upper bound on an index behind a coupling spring of this compliance, if torques lag; `None` if no
/// passive environment is known to be allowed.
///
/// All [compliances](MatchedCoupling) that the spring lacks count as deviations.
pub const fn limit_behind_spring<const UPDATES: bool>(
    period: f64,
    delta: Interval,
    compliance: Interval,
    latency: &Latency,
) -> Option<Interval> {
    let Some(window) = ResponseWindow::of::<UPDATES>(period, None, latency) else { return None };
    let t = Interval::decimal(period);
    let standard = t.div(delta.double());
    let (mut moment, mut sum) = (Interval::ZERO, Interval::ZERO);
    each!(m in 1..=window.whole + 1 => {
        let tap = window.tap(m);
        sum = sum.add(tap);
        moment = moment.add(tap.mul(Interval::exact(2.0 * m as f64 + 1.0)));
    });
    each!(i in 0..TRAILS => {
        let (gain, decay) = window.trails[i];
        if !gain.is_zero() {
            sum = sum.add(gain.div(Interval::ONE.sub(decay)));
            moment = moment.add(moments(window.whole as f64, decay, gain, Interval::ZERO));
        }
    });
    let excess = compliance.sub(standard.mul(window.tap(0)));
    let others = Deviation { moment: standard.mul(moment), sum: standard.mul(sum) };
    limit(t, delta, window.width, excess, &others)
}
