//! The rest of a step of the torque, between the earliest and the latest response that a scene allows
//! (theory, section 13.4).
//!
//! All times in this module are in periods.

use crate::latency::{Latency, TRAILS, TimeRange};
use crate::passivity::interval::Interval;
use crate::passivity::lagged::{SampledLag, SampledResponse, weights};
use crate::passivity::polynomial::Polynomial;

/// A decaying series of taps: the first, and the fraction of it that remains a tick later.
pub(crate) type Fading = (Interval, Interval);

/// The taps of a coupling over `T / (2 delta)`, as intervals:
/// `v_m = U_late(m - 1) - U_early(m)`, with `U(y)` the integral over all times after `y` of the rest of a step
/// (equation 54).
///
/// They fall from `width` to 0. Jitter makes torques earlier and later; so do ranges of delay and lag. If
/// torques and counts deviate at the same time, each has `both u_late(m)` more, with `u` the rest of a step.
#[derive(Clone, Copy)]
pub(crate) struct ResponseWindow {
    /// The longest time between two counts, and the mean delay of the latest response less that of the
    /// earliest: the device's passivity divided by it is left (equation 55).
    pub width: Interval,
    /// The longest time between two counts: 1 unless updates may be missed.
    pub between_counts: Interval,
    /// [Whole samples](Latency::whole_samples) that a torque takes: the taps after the next one are trails.
    pub whole: usize,
    /// The taps from `whole + 2` on: for each lag one series, or two if it is known in a range.
    pub trails: [Fading; TRAILS],
    /// The smaller of the widths of the windows of torques and of counts.
    both: Interval,
    early: End,
    late: End,
}

#[derive(Clone, Copy)]
struct End {
    delay: Interval,
    lags: [Interval; 2],
    /// The weight of each lag in the response of both.
    weights: [Interval; 2],
    /// `U(0)`, the mean delay of the lags.
    held_back: Interval,
    updates: u16,
}

#[derive(Clone, Copy)]
enum Quantity {
    /// `u`, the rest of a step.
    Rest,
    /// `U`, its integral from then on.
    Integral,
}

impl ResponseWindow {
    /// The window of a latency at this period and, if updates may be missed, at this longest time between two
    /// updates, in s. Without `UPDATES` there is none for an amplifier that is updated several times in a
    /// period.
    ///
    /// `None` if a number is out of range, if a torque may begin more than a period before its count, or if
    /// updates may be missed and the torque of a count does not have all of its effect within a period after it.
    pub const fn of<const UPDATES: bool>(
        period: f64,
        worst_period: Option<f64>,
        latency: &Latency,
    ) -> Option<Self> {
        if !UPDATES && latency.actuator_updates != 0
            || latency.total_jitter() > latency.largest_jitter(true, period)
        {
            return None;
        }
        let t = Interval::decimal(period);
        let delay = latency.torque_delay();
        let jitters =
            [Interval::decimal(latency.output_jitter), Interval::decimal(latency.count_jitter)];
        let jitter = jitters[0].add(jitters[1]).div(t);
        let both = jitters[0].min(jitters[1]).double().div(t);
        let range = [latency.actuator_lag, latency.sensor_lag_apart()];
        let (least, most) = (
            End::of::<UPDATES>(t, latency, delay.least, [range[0].least, range[1].least]),
            End::of::<UPDATES>(t, latency, delay.most, [range[0].most, range[1].most]),
        );
        let (Some(mut early), Some(mut late)) = (least, most) else { return None };
        let is_exact = range[0].is_exact() && range[1].is_exact();
        let longer_lags =
            if is_exact { Interval::ZERO } else { late.held_back.sub(early.held_back) };
        early.delay = early.delay.sub(jitter);
        if !latency.jitters_twice() && latency.total_jitter() <= latency.output_delay.least {
            early.delay = early.delay.and(Interval::new(0.0, f64::INFINITY));
        }
        let later = if UPDATES { latency.later_than_lag(period) } else { Interval::ZERO };
        late.delay = late.delay.add(jitter).add(later);
        let between_counts = match worst_period {
            Some(worst) if worst != period => {
                let is_alone =
                    range[0].is_zero() && range[1].is_zero() && latency.actuator_response.is_zero();
                let is_within = early.delay.lo() >= 0.0 && late.delay.hi() <= 1.0;
                if !is_alone || !is_within {
                    return None;
                }
                Interval::decimal(worst).div(t)
            }
            _ => Interval::ONE,
        };
        let spread = spread(delay).div(t).add(later);
        let apart = spread.add(jitter.double());
        if latency.jitters_twice() && !(is_exact && apart.hi() < ALMOST) {
            return None;
        }
        let width = between_counts.add(spread).add(jitter.double()).add(longer_lags);
        let width = width.add(both);
        let mut out = Self {
            width,
            between_counts,
            whole: latency.whole_samples(period),
            trails: [(Interval::ZERO, Interval::ZERO); TRAILS],
            both,
            early,
            late,
        };
        out.add_trails(&range);
        if width.is_finite() && out.tap(out.whole + 1).is_finite() { Some(out) } else { None }
    }

    /// `v_m`, for `m` up to `whole + 1`.
    pub const fn tap(&self, m: usize) -> Interval {
        let m = Interval::exact(m as f64);
        if m.hi() <= self.early.delay.lo() {
            return self.width;
        }
        let late = self.late.after(Quantity::Integral, m.sub(Interval::ONE).sub(self.late.delay));
        let held = late.sub(self.early.after(Quantity::Integral, m.sub(self.early.delay)));
        if self.both.is_zero() {
            return held;
        }
        held.add(self.both.mul(self.late.after(Quantity::Rest, m.sub(self.late.delay))))
    }

    /// The trails of both ends: those of the same time constant are one.
    const fn add_trails(&mut self, ranges: &[TimeRange; 2]) {
        let whole = Interval::exact(self.whole as f64);
        let arrived = whole.add(Interval::ONE).sub(self.late.delay);
        let earliest = whole.add(Interval::exact(2.0)).sub(self.early.delay);
        each!(i in 0..ranges.len() => {
            let late = self.late.by(i, Quantity::Integral, arrived);
            let early = self.early.by(i, Quantity::Integral, earliest);
            if !self.both.is_zero() {
                let later = arrived.add(Interval::ONE);
                let rest = self.both.mul(self.late.by(i, Quantity::Rest, later));
                self.trails[i] = (late.sub(early).add(rest), self.late.decay(i));
            } else if ranges[i].is_exact() {
                self.trails[i] = (late.sub(early), self.late.decay(i));
            } else {
                self.trails[i] = (late, self.late.decay(i));
                self.trails[ranges.len() + i] = (early.neg(), self.early.decay(i));
            }
        });
    }

    /// The sampled response `g` and ripple `D` of a device that has the passivity `delta / width` and no
    /// uncertainty: `g = T (z / (z - 1) - sum v_m z^-m / width)`, `D = T^2 / abs(z - 1)^2 - abs(g)^2`
    /// (equation 57); `None` beyond the degrees of a polynomial.
    #[inline(never)]
    pub const fn response(&self) -> Option<SampledResponse> {
        // The first taps, which are all of them `width`, are whole samples of delay.
        let first = match self.early.delay.lo() {
            earliest if earliest >= 0.0 => earliest as usize + 1,
            _ => 0,
        };
        let mut taps = [Interval::ZERO; MOST_TAPS];
        let last = self.whole + 1;
        if last - first >= taps.len() {
            return None;
        }
        each!(m in first..=last => {
            taps[last - m] = self.tap(m).div(self.width);
        });
        let mut trails = self.trails;
        each!(i in 0..TRAILS => {
            trails[i].0 = trails[i].0.div(self.width);
        });
        match with_trails(&Polynomial::ascending(&taps), &trails) {
            Some((absorbed, lag)) => {
                SampledResponse::absorbed(self.whole, last - first, &absorbed, lag)
            }
            None => None,
        }
    }
}

/// The most periods that the window of a constant response may be wide if torques and counts deviate at the
/// same time: below 1 by more than the rounding errors of a time.
const ALMOST: f64 = 1.0 - 1e-12;

/// Taps of a window that is as wide as the longest delays: more exceed the degrees of a polynomial.
const MOST_TAPS: usize = 10;

const fn spread(range: TimeRange) -> Interval {
    if range.is_exact() {
        return Interval::ZERO;
    }
    Interval::decimal(range.most).sub(Interval::decimal(range.least))
}

impl End {
    /// The response with this delay and these lags of amplifier and sensor, in s, without jitter.
    const fn of<const UPDATES: bool>(
        t: Interval,
        latency: &Latency,
        delay: f64,
        lags: [f64; 2],
    ) -> Option<Self> {
        let lags = [Interval::decimal(lags[0]).div(t), Interval::decimal(lags[1]).div(t)];
        let weights = some!(weights(lags));
        let delay = if UPDATES && latency.actuator_updates > 0 {
            some!(latency.delay_in_updates(t.midpoint()))
        } else {
            Interval::decimal(delay).div(t)
        };
        let updates = if UPDATES { latency.judged_updates() } else { 0 };
        let held_back = match updates {
            0 => lags[0].add(lags[1]),
            _ => SampledLag::of(updates, lags[0]).held(),
        };
        Some(Self { delay, lags, weights, held_back, updates })
    }

    /// The quantity at a time after the beginning of the response; before it, the rest is all of a step.
    ///
    /// An enclosure of 0 counts as before: `U` falls by at most 1 for each period, and in the proof all of a
    /// step may be left a little longer.
    const fn after(&self, quantity: Quantity, time: Interval) -> Interval {
        if time.lo() <= 0.0 {
            return match quantity {
                Quantity::Integral => self.held_back.sub(time),
                Quantity::Rest => Interval::ONE,
            };
        }
        self.by(0, quantity, time).add(self.by(1, quantity, time))
    }

    const fn by(&self, lag: usize, quantity: Quantity, time: Interval) -> Interval {
        let tau = self.lags[lag];
        if tau.is_zero() {
            return Interval::ZERO;
        }
        let weight = self.weights[lag];
        match (self.updates, quantity) {
            (0, Quantity::Integral) => weight.mul(time.div(tau).exp_of_negative()),
            (0, Quantity::Rest) => weight.div(tau).mul(time.div(tau).exp_of_negative()),
            (updates, Quantity::Integral) => SampledLag::of(updates, tau).held_after(time),
            (updates, Quantity::Rest) => SampledLag::of(updates, tau).rest_after(time),
        }
    }

    /// The fraction of that part which remains a period later.
    const fn decay(&self, lag: usize) -> Interval {
        let tau = self.lags[lag];
        if tau.is_zero() { Interval::ZERO } else { Interval::ONE.div(tau).exp_of_negative() }
    }
}

/// Taps, the last of them at `z^0`, and the trails that follow them: the numerator over `lag`, which is the
/// product of `z - decay`, and `lag`.
pub(crate) const fn with_trails(
    taps: &Polynomial,
    trails: &[Fading; TRAILS],
) -> Option<(Polynomial, Polynomial)> {
    let mut lag = Polynomial::ascending(&[Interval::ONE]);
    let mut after = Polynomial::ZERO;
    each!(i in 0..TRAILS => {
        let (gain, decay) = trails[i];
        if !gain.is_zero() {
            let pole = Polynomial::ascending(&[decay.neg(), Interval::ONE]);
            let mut trail = lag;
            trail.scale(gain);
            if !after.multiply(&pole) || !lag.multiply(&pole) {
                return None;
            }
            after.add(&trail);
        }
    });
    let mut all = *taps;
    if !all.multiply(&lag) {
        return None;
    }
    all.add(&after);
    Some((all, lag))
}
