//! The coupling that absorbs latency (theory, section 13.3).
//!
//! A coupling `V` behind which any passive environment, nonlinear or not, is passive with a torque that
//! lags: `V = (T z / (z - 1) - g) / (2 delta)` (equation 40), with `g` the sampled response of hold, delay and lags.
//! Where nothing lags it is the standard coupling `T / (2 delta)`. A delay of `(n + e) T` adds a spring
//! in series for each tick and part of a tick that a torque takes,
//!
//! ```text
//! V = (T / (2 delta)) (1 + 1/z + ... + z^-n + e z^-(n+1)),
//! ```
//!
//! and a lag a series of them that decays. All but the first depend on past torques alone: the servo
//! takes their deflection off the device's position, and solves the rest as it does for a spring.
//!
//! The coefficients are rounded, times are known in part, and a tick's count may be read late: for each
//! of these the first spring is made a little softer than the formula has it, by as much as the proof
//! asks for. [`MatchedCoupling::of`] computes both what the servo multiplies by and the limit that this
//! leaves to the environment's index, so that they cannot differ.

use crate::latency::{Latency, TimeRange};
use crate::number::{Format, Rounding};
use crate::parameter::MAX_DELAY;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::SampledLag;
use crate::passivity::polynomial::Polynomial;

/// How much softer the first spring is than the other deviations need, which costs the least index:
/// the limit falls with `(k + s/3)^2 / (k - s)` of its excess `k` over their sum `s`.
const EXCESS: f64 = 7.0 / 3.0;

/// What a lag leaves to later ticks: `gain` rad/(N m) of the torque before last, and `decay` of it in each
/// tick after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trail {
    /// Deflection in rad/(N m).
    pub gain: f64,
    /// The part of it that remains a tick later.
    pub decay: f64,
}

impl Trail {
    /// `z - decay`, or 1 where there is none.
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
    /// Compliance for each of that many torques before.
    pub held: f64,
    /// Compliance for the one before these.
    pub arriving: f64,
    /// Of the lags; a gain of 0 where there is none.
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
    /// For a device of this passivity (N m s/rad) at this period (s).
    ///
    /// `None` where a number is out of range, or where two lags are too much alike for their difference to be
    /// distinguished from zero.
    pub const fn of(
        period: f64,
        passivity: f64,
        latency: &Latency,
        format: Format,
    ) -> Option<Self> {
        Self::of_kind::<true>(period, passivity, latency, format)
    }

    /// The same; without `UPDATES` there is none for an amplifier that is updated some times in a period, and no
    /// code for that.
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
        // Above the standard coupling also where nothing lags, by a last bit.
        let compliance = format.coefficient(least.hi().next_up(), Rounding::Outward);
        let excess = Interval::exact(compliance).sub(standard).sub(given_up);
        let Some(limit) = limit(t, delta, excess, error) else { return None };
        Some(Self { compliance, limit, ..exact })
    }

    /// Numerator and denominator of `V(z)` with the coefficients that run; `None` beyond the degrees of a
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

    /// Sum of the magnitudes of all compliances: the most deflection in rad for torques of up to 1 N m each.
    pub(crate) fn largest_deflection(&self) -> f64 {
        let lasts = |trail: &Trail| trail.gain.abs() / (1.0 - trail.decay);
        let held = self.held * self.whole as f64 + self.arriving.abs();
        self.compliance + held + self.trails.iter().map(lasts).sum::<f64>()
    }

    /// Sum over the taps of `(2 m + 1)` times what rounding changed.
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
    /// Of the times at one place in their ranges.
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

    /// Sum of `(2 m + 1)` times each compliance but the first.
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

/// The part of each lag in what both together hold back, `tau_1^2 / (tau_1 - tau_2)` and the like.
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

/// What the ends of the ranges leave unknown of [`Taps::moment`]: every compliance grows with every
/// time.
const fn unknown<const UPDATES: bool>(t: Interval, latency: &Latency) -> Option<Interval> {
    let shortest = Taps::of::<UPDATES>(t, latency, Within::Least);
    let longest = Taps::of::<UPDATES>(t, latency, Within::Most);
    let (Some(shortest), Some(longest)) = (shortest, longest) else { return None };
    let range = longest.moment().sub(shortest.moment());
    Some(Interval::new(0.0, range.hi().max(0.0)))
}

/// The passivity that is left of a device whose torques or counts deviate in time from tick to tick by
/// `h T`, and the compliance that this takes of the coupling.
///
/// For any `s > 0` the work of the pulses by which such a torque differs is at most
/// `(s / 2) integral v^2 + (h T / (2 s)) sum (F_k - F_(k-1))^2`, and so is that of a count read late
/// (equation 42). The first comes off `delta`, the second off a spring: `s = 2 delta sqrt(h)` shares it
/// about equally.
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

/// What an index has to stay below behind a coupling with an `excess` of the first spring over the
/// formula and deviations of the others whose `sum (2 m + 1) abs(e_m)` is `error`; `None` where that
/// coupling is not known to be passive.
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

/// What an index has to stay below behind a coupling spring of this compliance, where torques lag;
/// `None` where no passive environment is known to be allowed.
///
/// All of the [compliances](MatchedCoupling) that the spring does not have count as deviations.
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
