//! Joint intervals of inertia, damping, lag and delay: the allowed lags, and the other numbers for every
//! allowed lag.
//!
//! The squares of the fit are not quadratic in the lag: a response depends on the square of a short lag, and
//! a lag is not below zero. So no interval is taken from the slopes at the best fit: for each lag the others
//! are fitted ([`least_squares`](super::least_squares)), and every device whose squares are above the least
//! by no more than the threshold of the confidence is inside.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::estimate::{CONFIDENCE, Estimate};
use super::least_squares::{Delay, Fit, Measured};
use super::model::Model;

/// Shortest lag that is tried besides 0, as phase in rad of the fastest response: a response is known to a
/// part in 1e7 at best.
const SHORTEST: f64 = 1e-4;
/// Ratio of each lag to the previous one.
const RATIO: f64 = 1.25;
/// Largest number of them: from the shortest to the longest there is a factor of 1e9.
const MOST: usize = 95;
/// Number of successive lags at which the squares rise and are beyond the least by [`FAR`] thresholds; after
/// them no longer lag is tried.
const RISES: usize = 4;
/// See [`RISES`].
const FAR: f64 = 10.0;
/// Steps by which the range that contains the best lag or an end is reduced.
const HALVINGS: usize = 24;
/// Lags between the ends of an interval at which the intervals of the other numbers are taken.
const SAMPLES: usize = 32;
/// Number of thresholds by which a negative delay must lower the squares, compared with delays of 0 and more,
/// to be accepted.
const EARLIER: f64 = 2.0;

/// All devices that the responses allow.
#[derive(Clone, Debug)]
pub struct Profile {
    pub best: Fit,
    /// Fits at lags from the shortest to the longest that is allowed.
    fits: Vec<Fit>,
    /// Largest allowed excess of squares over the least.
    threshold: f64,
    /// Mean squared residual in squared deviations.
    pub misfit: f64,
    /// Whether the lag has no upper end, and why not.
    pub open: Option<Open>,
    /// Whether the responses are too early for a lag and a delay of 0 and more.
    pub is_early: bool,
}

/// The end of the allowed lags, where the responses do not set it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Open {
    /// At the lag in s at which it and the time constant of the device would change places, or their order is
    /// arbitrary.
    Exchange(f64),
    /// At the longest lag in s that the amplifier may have.
    Longest(f64),
}

/// Longest lag that is assumed for an amplifier if none is declared, in periods: a servo with a slower
/// amplifier does not gain from its sampling rate.
const LONGEST: f64 = 0.5;

impl Profile {
    /// The profile of these responses, with an amplifier whose lag is at most `longest` in s. `None` where
    /// they do not determine a device.
    pub fn of(measured: &Measured<'_>, longest: Option<f64>) -> Option<Self> {
        let begin = measured.rough_delay()?;
        let begin = measured.fit(0.0, Delay::From(begin))?.model.delay;
        let squares = Squares { measured, begin, longest, may_be_early: false };
        let profile = Self::within(&squares)?;
        let best = &profile.best;
        if best.is_delay_free && best.model.delay >= 0.0 {
            return Some(profile);
        }
        let early = Self::within(&Squares { may_be_early: true, ..squares })?;
        let gain = profile.best.squares - early.best.squares;
        Some(match gain > EARLIER * early.threshold {
            true => Self { is_early: true, ..early },
            false => profile,
        })
    }

    fn within(squares: &Squares<'_>) -> Option<Self> {
        let friction = f64::from(u8::from(squares.measured.with_friction));
        let freedom = 2.0 * squares.measured.responses.len() as f64 - UNKNOWNS - friction;
        if freedom <= 0.0 {
            return None;
        }
        let quantile = student(freedom);
        let threshold = |least: f64| quantile * quantile * (least / freedom).max(1.0);
        let (tried, reached) = squares.tried(threshold);
        let at = (0..tried.len()).min_by(|&a, &b| tried[a].squares.total_cmp(&tried[b].squares))?;
        let best = squares.best_between(&tried[at.saturating_sub(1)..tried.len().min(at + 2)])?;
        let threshold = threshold(best.squares);
        let is_allowed = |fit: &Fit| fit.squares <= best.squares + threshold;
        let lag = best.model.lag;
        let below = tried.iter().rev().find(|fit| fit.model.lag < lag && !is_allowed(fit));
        let above = tried.iter().find(|fit| fit.model.lag > lag && !is_allowed(fit));
        let end = |outside: Option<&Fit>, otherwise: f64| match outside {
            Some(fit) => squares.last(lag, fit.model.lag, is_allowed),
            None => otherwise,
        };
        let longest = tried.last().map_or(lag, |fit| fit.model.lag);
        let (from, to) = (end(below, 0.0), end(above, longest.max(lag)));
        let between = (0..=SAMPLES).map(|i| from + (to - from) * i as f64 / SAMPLES as f64);
        let fits = between.filter_map(|lag| squares.at(lag)).chain([best]).filter(is_allowed);
        Some(Self {
            best,
            fits: fits.collect(),
            threshold,
            misfit: best.squares / freedom,
            open: squares.open(&best, above.is_none().then_some(reached).flatten(), from),
            is_early: false,
        })
    }

    pub fn damping(&self) -> Estimate {
        self.estimate(|model| model.damping, |fit| fit.deviations[0], |_| f64::NEG_INFINITY)
    }

    /// Inertia in kg m^2. If it cannot be distinguished from the lag, the two may be exchanged.
    pub fn inertia(&self) -> Estimate {
        let found =
            self.estimate(|model| model.inertia, |fit| fit.deviations[1], |_| f64::NEG_INFINITY);
        let exchanged = self.fits.iter().map(|fit| fit.model.lag * fit.model.damping);
        let least = exchanged.fold(found.lo, f64::min);
        Estimate {
            lo: if matches!(self.open, Some(Open::Exchange(_))) { least } else { found.lo },
            ..found
        }
    }

    pub fn friction(&self) -> Estimate {
        let found =
            self.estimate(|model| model.friction, |fit| fit.deviations[3], |_| f64::NEG_INFINITY);
        Estimate { lo: found.lo.max(0.0), ..found }
    }

    pub fn delay(&self) -> Estimate {
        self.estimate(|model| model.delay, |fit| fit.deviations[2], |_| 0.0)
    }

    /// Time constant in s of the lag.
    pub fn lag(&self) -> Estimate {
        self.estimate(|model| model.lag, |_| 0.0, |_| 0.0)
    }

    /// Sum in s of lag and delay.
    pub fn mean_delay(&self) -> Estimate {
        self.estimate(Model::mean_delay, |fit| fit.deviations[2], |model| model.lag)
    }

    /// The interval over all allowed devices; behind a lag the number is at least the value of `least`.
    fn estimate(
        &self,
        number: impl Fn(&Model) -> f64,
        deviation: impl Fn(&Fit) -> f64,
        least: impl Fn(&Model) -> f64,
    ) -> Estimate {
        let value = number(&self.best.model);
        let wider = |range: Estimate, fit: &Fit| {
            let left = (self.best.squares + self.threshold - fit.squares).max(0.0);
            let (at, reach) = (number(&fit.model), left.sqrt() * deviation(fit));
            let behind_lag = fit.model.lag > 0.0 && !self.is_early;
            let lo = if behind_lag { (at - reach).max(least(&fit.model)) } else { at - reach };
            Estimate { lo: range.lo.min(lo), hi: range.hi.max(at + reach), ..range }
        };
        self.fits.iter().fold(Estimate { value, lo: value, hi: value }, wider)
    }
}

/// Damping, inertia, lag and delay; friction is one more.
const UNKNOWNS: f64 = 4.0;

/// Two-sided quantile of Student's distribution.
pub fn student(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom)
        .map_or(f64::INFINITY, |student| student.inverse_cdf(0.5 + 0.5 * CONFIDENCE))
}

/// The best fits as a function of the lag.
struct Squares<'a> {
    measured: &'a Measured<'a>,
    /// Delay in s without lag.
    begin: f64,
    /// Longest lag in s that was declared.
    longest: Option<f64>,
    /// Whether there may be a negative delay behind a lag.
    may_be_early: bool,
}

impl Squares<'_> {
    /// The longest lag in s that is tried.
    fn longest(&self) -> f64 {
        self.longest.unwrap_or(LONGEST * self.measured.period)
    }

    /// Why the allowed lags have no upper end, if they have none. They begin at `from` in s; `reached` is the
    /// end of the tried lags, if they extend to it.
    fn open(&self, best: &Fit, reached: Option<Open>, from: f64) -> Option<Open> {
        let of_device = best.model.inertia / best.model.damping;
        match reached {
            // The responses leave the end open, and the declaration sets it.
            Some(Open::Longest(_)) if self.longest.is_some() && from == 0.0 => None,
            Some(end) => Some(end),
            // The device's time constant might as well be the amplifier's.
            None => (0.0..self.longest()).contains(&of_device).then_some(Open::Exchange(of_device)),
        }
    }

    /// The best fit with an allowed delay. Without a lag the delay may be negative, because counts may be
    /// younger than their time.
    fn at(&self, lag: f64) -> Option<Fit> {
        let fit = self.measured.fit(lag, Delay::From(self.begin - lag));
        let may_be = |fit: &Fit| lag == 0.0 || self.may_be_early || fit.model.delay >= 0.0;
        match fit {
            Some(fit) if may_be(&fit) => Some(fit),
            _ if lag > 0.0 && !self.may_be_early => self.measured.fit(lag, Delay::Fixed(0.0)),
            _ => None,
        }
    }

    /// Whether the device's inertia can be distinguished from the lag: `(b + j w m) (1 + j w tau)` is the
    /// same where `tau` and `m/b` change places, so the shorter of them counts as the lag.
    fn is_told(fit: &Fit) -> bool {
        fit.model.lag * fit.model.damping < fit.model.inertia
    }

    /// Fits at lags far apart, and where they end, unless they end because the squares are far too large.
    fn tried(&self, threshold: impl Fn(f64) -> f64) -> (Vec<Fit>, Option<Open>) {
        let shortest = SHORTEST / self.measured.fastest();
        let lags = (0..MOST).map(|i| shortest * RATIO.powi(i as i32));
        let (mut tried, mut rises) = (Vec::<Fit>::new(), 0);
        let mut least = f64::INFINITY;
        let longest = self.longest();
        let lags = [0.0].into_iter().chain(lags.take_while(|lag| *lag < longest)).chain([longest]);
        for lag in lags {
            let Some(fit) = self.at(lag) else { continue };
            if !Self::is_told(&fit) {
                let told = tried.last().map_or(0.0, |fit| fit.model.lag);
                let last = self.at(self.last(told, lag, Self::is_told));
                tried.extend(last);
                return (tried, last.map(|fit| Open::Exchange(fit.model.lag)));
            }
            let before = tried.last().map_or(f64::INFINITY, |fit| fit.squares);
            least = least.min(fit.squares);
            let is_far = fit.squares > before && fit.squares > least + FAR * threshold(least);
            rises = if is_far { rises + 1 } else { 0 };
            tried.push(fit);
            if rises == RISES {
                return (tried, None);
            }
        }
        (tried, Some(Open::Longest(longest)))
    }

    /// The best fit in a range that holds one minimum, by thirds.
    fn best_between(&self, tried: &[Fit]) -> Option<Fit> {
        let (mut from, mut to) = (tried.first()?.model.lag, tried.last()?.model.lag);
        let mut best = *tried.iter().min_by(|a, b| a.squares.total_cmp(&b.squares))?;
        for _ in 0..HALVINGS {
            let third = (to - from) / 3.0;
            let (Some(a), Some(b)) = (self.at(from + third), self.at(to - third)) else { break };
            if a.squares < b.squares {
                to -= third
            } else {
                from += third
            }
            let better = if a.squares < b.squares { a } else { b };
            if better.squares < best.squares {
                best = better;
            }
        }
        Some(best)
    }

    /// The last lag of those that hold, between a lag that does and a lag that does not.
    fn last(&self, mut inside: f64, mut outside: f64, holds: impl Fn(&Fit) -> bool) -> f64 {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            match self.at(middle) {
                Some(fit) if holds(&fit) => inside = middle,
                _ => outside = middle,
            }
        }
        inside
    }
}
