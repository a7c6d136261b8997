//! The coupling that absorbs latency (theory, section 13.3).
//!
//! A coupling `V` behind which any passive environment, linear or not, is passive with a lagging torque:
//! `V = (T z / (z - 1) - g) / (2 delta)` (equation 40), with `g` the sampled response of hold, delay and
//! lags. Without latency it is the standard coupling `T / (2 delta)`. A delay of `(n + e) T` adds a spring in
//! series for each tick and part of a tick that a torque takes,
//!
//! ```text
//! V = (T / (2 delta)) (1 + 1/z + ... + z^-n + e z^-(n+1)),
//! ```
//!
//! and a lag a decaying series of them. All except the first depend only on past torques: the servo subtracts
//! their deflection from the device's position, and solves the rest as for a spring.
//!
//! Coefficients are rounded, times may be ranges, and a tick's count may be read late: for each of these the
//! first spring is a little softer than in the formula, as the proof requires. [`MatchedCoupling::of`]
//! computes both the servo's coefficients and the resulting limit on the environment's index, so that they
//! cannot disagree.

use crate::latency::{Latency, TimeRange};
use crate::number::{Format, Rounding};
use crate::parameter::MAX_DELAY;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::SampledLag;
use crate::passivity::polynomial::Polynomial;

/// The ratio of the first spring's excess `k` to the sum `s` of the other deviations that leaves the largest
/// limit: the loss is proportional to `(k + s/3)^2 / (k - s)`.
const EXCESS: f64 = 7.0 / 3.0;

/// The effect of a lag in later ticks: `gain` rad/(N m) of the torque before last, and the fraction `decay`
/// of it in each following tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trail {
    /// Deflection in rad/(N m).
    pub gain: f64,
    /// The fraction of it that remains a tick later.
    pub decay: f64,
}

impl Trail {
    /// `z - decay`, or 1 without a lag.
    const fn pole(&self) -> Polynomial {
        if self.gain == 0.0 {
            return Polynomial::ascending(&[Interval::ONE]);
        }
        Polynomial::ascending(&[Interval::exact(-self.decay), Interval::ONE])
    }
}

/// The coupling's coefficients as a number format rounds them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchedCoupling {
    /// Compliance in rad/(N m) for the torque of this tick.
    pub compliance: f64,
    /// Whole samples that a torque takes.
    pub whole: usize,
    /// Compliance for each of this many earlier torques.
    pub held: f64,
    /// Compliance for the torque before these.
    pub arriving: f64,
    /// The trails of the lags; with a gain of 0 without a lag.
    pub trails: [Trail; 2],
    /// Upper bound on the environment's index in N m s/rad.
    pub limit: Interval,
}

/// Compliances of one latency over `T / (2 delta)`: exact, as intervals.
#[derive(Clone, Copy)]
struct Taps {
    whole: usize,
    arriving: Interval,
    trails: [(Interval, Interval); 2],
}

impl MatchedCoupling {
    /// The coupling for a device of this passivity (N m s/rad) at this period (s).
    ///
    /// `None` if a number is out of range, or if two lags are so nearly equal that their difference cannot be
    /// distinguished from zero.
    pub const fn of(
        period: f64,
        passivity: f64,
        latency: &Latency,
        format: Format,
    ) -> Option<Self> {
        Self::of_kind::<true>(period, passivity, latency, format)
    }

    /// The same; without `UPDATES` there is no coupling, and no code, for an amplifier that is updated
    /// several times in a period.
    #[inline(never)]
    pub(crate) const fn of_kind<const UPDATES: bool>(
        period: f64,
        passivity: f64,
        latency: &Latency,
        format: Format,
    ) -> Option<Self> {
        if !UPDATES && latency.actuator_updates != 0 {
            return None;
        }
        let (t, delta) = (Interval::decimal(period), Interval::decimal(passivity));
        let Some((delta, given_up)) = after_jitter(t, delta, latency) else { return None };
        let standard = t.div(delta.double());
        let Some(taps) = Taps::of::<UPDATES>(t, latency, Within::Middle) else { return None };
        let Some(unknown) = unknown::<UPDATES>(t, latency) else { return None };
        let held = format.coefficient(standard.midpoint(), Rounding::Nearest);
        let arriving =
            format.coefficient(standard.mul(taps.arriving).midpoint(), Rounding::Nearest);
        let trails =
            [rounded(standard, taps.trails[0], format), rounded(standard, taps.trails[1], format)];
        let exact = Self {
            compliance: 0.0,
            whole: taps.whole,
            held,
            arriving,
            trails,
            limit: Interval::ENTIRE,
        };
        let error = exact.rounding(standard, &taps).add(standard.mul(unknown));
        let least = standard.add(given_up).add(error.mul(Interval::exact(EXCESS)));
        // Above the standard coupling even without latency, by a last bit.
        let compliance = format.coefficient(least.hi().next_up(), Rounding::Outward);
        let excess = Interval::exact(compliance).sub(standard).sub(given_up);
        let Some(limit) = limit(t, delta, excess, error) else { return None };
        Some(Self { compliance, limit, ..exact })
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
        let mut i = 1;
        while i < last {
            taps[i] = Interval::exact(self.held);
            i += 1;
        }
        taps[0] = Interval::exact(self.arriving);
        let poles = [self.trails[0].pole(), self.trails[1].pole()];
        let (Some(lag), Some(taps)) =
            (poles[0].times(&poles[1]), both(&Polynomial::ascending(&taps), &poles))
        else {
            return None;
        };
        let first = poles[1].scaled(Interval::exact(self.trails[0].gain));
        let second = poles[0].scaled(Interval::exact(self.trails[1].gain));
        match lag.shifted_up(last) {
            Some(denominator) => Some((taps.plus(&first).plus(&second), denominator)),
            None => None,
        }
    }

    /// Sum of the magnitudes of all compliances: the largest deflection in rad for torques of up to 1 N m
    /// each.
    pub(crate) fn largest_deflection(&self) -> f64 {
        let lasts = |trail: &Trail| trail.gain.abs() / (1.0 - trail.decay);
        let held = self.held * self.whole as f64 + self.arriving.abs();
        self.compliance + held + self.trails.iter().map(lasts).sum::<f64>()
    }

    /// Sum over the taps of `(2 m + 1)` times the rounding error.
    const fn rounding(&self, standard: Interval, taps: &Taps) -> Interval {
        let n = self.whole as f64;
        let held = Interval::exact(self.held).sub(standard).abs();
        let arriving = Interval::exact(self.arriving).sub(standard.mul(taps.arriving)).abs();
        let mut sum = held.mul(Interval::exact(n * (n + 2.0)));
        sum = sum.add(arriving.mul(Interval::exact(2.0 * n + 3.0)));
        let mut i = 0;
        while i < self.trails.len() {
            let (gain, decay) = taps.trails[i];
            let run = self.trails[i];
            let gain = standard.mul(gain);
            if !gain.is_zero() {
                let first = Interval::exact(run.gain).sub(gain).abs();
                let later = Interval::exact(run.decay).sub(decay).abs();
                let slowest = Interval::exact(run.decay).max(decay);
                sum = sum.add(moments(n, slowest, first, gain.abs().mul(later)));
            }
            i += 1;
        }
        sum
    }
}

const fn both(p: &Polynomial, factors: &[Polynomial; 2]) -> Option<Polynomial> {
    match p.times(&factors[0]) {
        Some(p) => p.times(&factors[1]),
        None => None,
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

impl Taps {
    /// The taps for the times at one place in their ranges.
    const fn of<const UPDATES: bool>(
        t: Interval,
        latency: &Latency,
        place: Within,
    ) -> Option<Self> {
        let updates = if UPDATES { latency.actuator_updates } else { 0 };
        let delay = match updates {
            0 => place.of(latency.torque_delay()).div(t),
            _ => match latency.delay_in_updates(t.midpoint()) {
                Some(delay) => delay,
                None => return None,
            },
        };
        let whole = delay.midpoint().max(0.0) as usize;
        let part = delay.sub(Interval::exact(whole as f64));
        let rest = Interval::ONE.sub(part);
        let lags = [place.of(latency.actuator_lag).div(t), place.of(latency.sensor_lag).div(t)];
        let Some(mut weights) = weights(lags) else { return None };
        if updates != 0 {
            weights[0] = SampledLag::of(updates, lags[0]).held();
        }
        let mut taps =
            Self { whole, arriving: part, trails: [(Interval::ZERO, Interval::ZERO); 2] };
        let mut i = 0;
        while i < lags.len() {
            if !lags[i].is_zero() {
                let left = rest.div(lags[i]).exp_of_negative();
                let decay = Interval::ONE.div(lags[i]).exp_of_negative();
                let passed = Interval::ONE.sub(left);
                taps.arriving = taps.arriving.add(weights[i].mul(passed));
                let gain = weights[i].mul(left).mul(Interval::ONE.sub(decay));
                taps.trails[i] = (gain, decay);
            }
            i += 1;
        }
        if taps.arriving.is_finite() { Some(taps) } else { None }
    }

    /// Sum of `(2 m + 1)` times each compliance except the first.
    const fn moment(&self) -> Interval {
        let n = self.whole as f64;
        let mut sum = Interval::exact(n * (n + 2.0));
        sum = sum.add(self.arriving.mul(Interval::exact(2.0 * n + 3.0)));
        let mut i = 0;
        while i < self.trails.len() {
            let (gain, decay) = self.trails[i];
            if !gain.is_zero() {
                sum = sum.add(moments(n, decay, gain, Interval::ZERO));
            }
            i += 1;
        }
        sum
    }
}

/// The weight of each lag in the response of both, `tau_1^2 / (tau_1 - tau_2)` and the like.
const fn weights(lags: [Interval; 2]) -> Option<[Interval; 2]> {
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

/// A place in the range of each time.
#[derive(Clone, Copy)]
enum Within {
    Least,
    Middle,
    Most,
}

impl Within {
    const fn of(self, range: TimeRange) -> Interval {
        Interval::decimal(match self {
            Self::Least => range.least,
            Self::Middle => range.middle(),
            Self::Most => range.most,
        })
    }
}

/// The uncertainty of [`Taps::moment`] by the ranges of the times: every compliance grows with every time.
const fn unknown<const UPDATES: bool>(t: Interval, latency: &Latency) -> Option<Interval> {
    let shortest = Taps::of::<UPDATES>(t, latency, Within::Least);
    let longest = Taps::of::<UPDATES>(t, latency, Within::Most);
    let (Some(shortest), Some(longest)) = (shortest, longest) else { return None };
    let range = longest.moment().sub(shortest.moment());
    Some(Interval::new(0.0, range.hi().max(0.0)))
}

/// The remaining passivity of a device whose torques or counts deviate in time from tick to tick by `h T`,
/// and the loss of the coupling's compliance.
///
/// For any `s > 0` the work of the pulses by which such a torque differs is at most
/// `(s / 2) integral v^2 + (h T / (2 s)) sum (F_k - F_(k-1))^2`, and so is that of a count read late
/// (equation 42). The first is subtracted from `delta`, the second from a spring: `s = 2 delta sqrt(h)`
/// divides the loss about equally.
const fn after_jitter(
    t: Interval,
    delta: Interval,
    latency: &Latency,
) -> Option<(Interval, Interval)> {
    if latency.output_jitter == 0.0 {
        return Some((delta, Interval::ZERO));
    }
    let h = Interval::decimal(latency.output_jitter).div(t);
    let share = h.sqrt().midpoint();
    if !(share > 0.0 && share < 1.0) {
        return None;
    }
    let share = Interval::exact(share);
    let given_up = h.mul(t).div(delta.double().mul(share));
    Some((delta.mul(Interval::ONE.sub(share)), given_up))
}

const fn rounded(standard: Interval, trail: (Interval, Interval), format: Format) -> Trail {
    let (gain, decay) = trail;
    Trail {
        gain: format.coefficient(standard.mul(gain).midpoint(), Rounding::Nearest),
        decay: format.coefficient(decay.midpoint(), Rounding::Nearest),
    }
}

/// The upper bound on an index behind a coupling with an `excess` of the first spring over the formula and
/// deviations of the others with `sum (2 m + 1) abs(e_m)` equal to `error`; `None` if that coupling is not
/// known to be passive.
///
/// `Q = (1 - 1/z) (excess - sum e_m z^-m) / T` has `Re Q >= (1 - c) (excess - error) / T`, since
/// `abs(cos(m x) - cos((m + 1) x)) <= (2 m + 1) (1 - cos x)`, and `abs(Q)^2 <= 2 (1 - c) (excess +
/// error / 3)^2 / T^2`: that is its output strict passivity `gamma`, and condition 18 is
/// `alpha < delta gamma / (delta + gamma)` (equation 41).
pub const fn limit(
    t: Interval,
    delta: Interval,
    excess: Interval,
    error: Interval,
) -> Option<Interval> {
    let margin = excess.sub(error);
    if !margin.is_positive() || !delta.is_positive() {
        return if excess.is_zero() && error.is_zero() { Some(delta) } else { None };
    }
    let most = excess.add(error.div(Interval::exact(3.0)));
    // delta / (1 + delta / gamma)
    let over = delta.double().mul(most).mul(most).div(t.mul(margin));
    Some(delta.div(Interval::ONE.add(over)))
}

/// The upper bound on an index behind a coupling spring of this compliance, if torques lag; `None` if no
/// passive environment is known to be allowed.
///
/// All [compliances](MatchedCoupling) that the spring lacks count as deviations.
pub const fn limit_behind_spring<const UPDATES: bool>(
    t: Interval,
    delta: Interval,
    compliance: Interval,
    latency: &Latency,
) -> Option<Interval> {
    if !UPDATES && latency.actuator_updates != 0 {
        return None;
    }
    let Some((delta, given_up)) = after_jitter(t, delta, latency) else { return None };
    let Some(taps) = Taps::of::<UPDATES>(t, latency, Within::Most) else { return None };
    let standard = t.div(delta.double());
    let excess = compliance.sub(standard).sub(given_up);
    limit(t, delta, excess, standard.mul(taps.moment()))
}
