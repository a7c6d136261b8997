//! The rule for linear scenes whose torque lags: equation 38 at the device's port.

use super::deviation::Deviation;
use super::loop_intervals::Lagging;
use super::problem::PassivityProblem;
use super::rules::RuleAnswer;
use crate::latency::{Latency, TimeRange};
use crate::passivity::bernstein::Precision;
use crate::passivity::discrete::RealPart;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::{LagIntervals, Port, SampledResponse, ripple_of_mixture};
use crate::passivity::poles::{IndexError, UndecidedReason, cancelled};
use crate::passivity::transfer::Transfer;

/// The number of parts into which the range of a time is divided: the enclosure of each part is tighter than
/// one of the whole range.
const PARTS: usize = 8;

/// The ranges of all times, divided into parts.
#[derive(Clone, Copy)]
struct Cells {
    delay: TimeRange,
    actuator: TimeRange,
    sensor: TimeRange,
    /// Updates of the current loop in a period, and the delay in updates; 0 if the loop is continuous.
    updates: u16,
    delay_in_updates: Interval,
    between: bool,
}

impl Cells {
    /// `None` if a current loop is updated and its delay is not a whole number of updates, or a sensor filter stands
    /// beside it.
    const fn of(lagging: &Lagging, period: Interval) -> Option<Self> {
        let latency = &lagging.latency;
        if latency.is_filtered_beside_updates() {
            return None;
        }
        Some(Self {
            delay: latency.output_delay,
            actuator: latency.actuator_lag,
            sensor: latency.sensor_lag,
            updates: latency.actuator_updates,
            delay_in_updates: match latency.actuator_updates {
                0 => Interval::ZERO,
                _ => some!(latency.delay_in_updates(period.midpoint())),
            },
            between: latency.is_between_updates(),
        })
    }

    const fn count(&self) -> usize {
        parts(self.delay) * parts(self.actuator) * parts(self.sensor)
    }

    /// One of the cells, in periods.
    const fn cell(&self, index: usize, period: Interval) -> LagIntervals {
        let (delays, actuators) = (parts(self.delay), parts(self.actuator));
        LagIntervals {
            delay: match self.updates {
                0 => part(self.delay, index % delays).div(period),
                _ => self.delay_in_updates,
            },
            lags: [
                part(self.actuator, index / delays % actuators).div(period),
                part(self.sensor, index / delays / actuators).div(period),
            ],
            updates: self.updates,
            between: self.between,
        }
    }
}

/// An amplifier that is only known by the beginning and the end of its step response: the corners of the
/// sampled response, and its largest ripple (theory, section 13.7).
#[derive(Clone, Copy)]
struct Corners {
    /// The ends of the delay's range, in periods.
    ends: [Interval; 2],
    /// The first whole sample above the lower end.
    first_whole: i32,
    /// Whole samples between the ends.
    wholes: usize,
    ripple: Interval,
}

impl Corners {
    const fn of(lagging: &Lagging, period: Interval) -> Option<Self> {
        let Latency { output_delay, actuator_response, .. } = lagging.latency;
        if actuator_response.is_zero() {
            return None;
        }
        let least = after(output_delay.least, actuator_response.least).div(period);
        let most = after(output_delay.most, actuator_response.most).div(period);
        let first_whole = least.hi().max(0.0) as i32 + 1;
        let last_whole = most.hi().max(0.0) as i32;
        let wholes = if last_whole < first_whole { 0 } else { last_whole - first_whole + 1 };
        Some(Self {
            ends: [least, most],
            first_whole,
            wholes: wholes as usize,
            ripple: ripple_of_mixture(least, most),
        })
    }

    const fn count(&self) -> usize {
        self.ends.len() + self.wholes
    }

    const fn corner(&self, index: usize) -> LagIntervals {
        let delay = if index < self.ends.len() {
            self.ends[index]
        } else {
            let whole = self.first_whole + (index - self.ends.len()) as i32;
            Interval::exact(whole as f64)
        };
        LagIntervals { delay, lags: [Interval::ZERO, Interval::ZERO], updates: 0, between: false }
    }
}

#[derive(Clone, Copy)]
enum Times {
    Cells(Cells),
    Corners(Corners),
}

impl Times {
    const fn of(lagging: &Lagging, period: Interval) -> Option<Self> {
        let cells = some!(Cells::of(lagging, period));
        Some(match Corners::of(lagging, period) {
            Some(corners) => Self::Corners(corners),
            None => Self::Cells(cells),
        })
    }

    const fn count(&self) -> usize {
        match self {
            Self::Cells(cells) => cells.count(),
            Self::Corners(corners) => corners.count(),
        }
    }

    /// A part of them, in periods.
    const fn part(&self, index: usize, period: Interval) -> LagIntervals {
        match self {
            Self::Cells(cells) => cells.cell(index, period),
            Self::Corners(corners) => corners.corner(index),
        }
    }

    const fn response(&self, part: &LagIntervals, piece: usize) -> Option<SampledResponse> {
        let response = some!(part.response(piece));
        Some(match self {
            Self::Cells(_) => response,
            Self::Corners(corners) => response.with_ripple(corners.ripple),
        })
    }
}

/// One time after another.
const fn after(first: f64, then: f64) -> Interval {
    Interval::decimal(first).add(Interval::decimal(then))
}

/// The product, without rounding for a factor of 1.
const fn scaled(value: Interval, factor: Interval) -> Interval {
    if factor.is_exact() && factor.contains(1.0) { value } else { value.mul(factor) }
}

const fn parts(range: TimeRange) -> usize {
    if range.is_exact() { 1 } else { PARTS }
}

const fn part(range: TimeRange, index: usize) -> Interval {
    if range.is_exact() {
        return Interval::decimal(range.least);
    }
    let (least, most) = (Interval::decimal(range.least), Interval::decimal(range.most));
    let step = most.sub(least).div(Interval::exact(PARTS as f64));
    let from = least.add(step.mul(Interval::exact(index as f64)));
    let to = least.add(step.mul(Interval::exact(index as f64 + 1.0)));
    Interval::new(from.lo().max(0.0), to.hi())
}

/// The larger of both, if there are two.
const fn larger(one: (RealPart, Interval), before: Found) -> Found {
    Ok(match before {
        Ok(before) => (one.0.or_larger(before.0), one.1.max(before.1)),
        Err(_) => one,
    })
}

/// The sampled responses of a scene's delays and lags over all their ranges, stored in a `V` such as a
/// vector.
///
/// Scenes that differ only in their environment share them, and they take longer to compute than the rest of
/// an answer: see [`PassivityProblem::answer_with`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptResponses<V> {
    latency: Latency,
    period: Interval,
    responses: V,
}

/// The smaller of both, if either is known.
const fn better(a: Found, b: Found) -> Found {
    match (a, b) {
        (Ok(a), Ok(b)) => {
            let index = if b.0.minimum.hi() < a.0.minimum.hi() { b.0 } else { a.0 };
            let minimum = a.0.minimum.min(b.0.minimum);
            Ok((RealPart { minimum, ..index }, a.1.min(b.1)))
        }
        (Ok(known), Err(_)) | (Err(_), Ok(known)) => Ok(known),
        (Err(_), Err(error)) => Err(error),
    }
}

/// The index, and the least sufficient passivity.
type Found = Result<(RealPart, Interval), IndexError>;

const UNKNOWN: IndexError = IndexError::Undecided(UndecidedReason::OutOfRange);

impl PassivityProblem {
    /// The largest `-Re(H g) + D abs(H)^2 / (4 delta)`, which proves the scene if it is below the passivity.
    /// Where a delay deviates from tick to tick, `delta` is the part of it that is [left](Deviation), and the
    /// result is divided by that part.
    #[inline(never)]
    pub(super) const fn port_index(&self, closeness: &Precision) -> Result<RealPart, IndexError> {
        let (found, _) = ok!(self.over_cells(closeness, false));
        Ok(found)
    }

    /// Index at the port with delay, lag and sensor, in N m s/rad: the least sufficient passivity of a
    /// device. A delay that deviates from tick to tick counts with its ripple.
    #[inline(never)]
    pub(super) const fn port_needed(&self) -> Result<Interval, IndexError> {
        let (_, needed) = ok!(self.over_cells(&Precision::TIGHT, true));
        Ok(needed)
    }

    /// The smallest of both over the proofs for this scene; the second only on request, and the proofs up to
    /// the first that is enough otherwise.
    pub(super) const fn over_cells(&self, closeness: &Precision, and_needed: bool) -> Found {
        self.over_proofs(None, closeness, and_needed)
    }

    /// The same with the responses of all times, if they are stored.
    const fn over_proofs(
        &self,
        kept: Option<&[SampledResponse]>,
        closeness: &Precision,
        and_needed: bool,
    ) -> Found {
        let at_the_port = self.at_the_port();
        let (h, lagging) = match &at_the_port {
            Ok((h, lagging)) => (h, *lagging),
            Err(error) => return Err(*error),
        };
        let mut best = Err(UNKNOWN);
        each!(proof in 0..Deviation::COUNT => {
            if let Some(deviation) = &Deviation::of(proof, lagging, &self.numbers) {
                let found = match (&deviation.response, kept) {
                    (Some(response), _) => {
                        self.piece(h, response, deviation, closeness, and_needed)
                    }
                    (None, Some(kept)) => {
                        self.over_kept(kept, h, deviation, closeness, and_needed)
                    }
                    (None, None) => {
                        self.over_ranges(h, lagging, deviation, closeness, and_needed)
                    }
                };
                best = better(best, found);
                if !and_needed && self.is_enough(&best) {
                    return best;
                }
            }
        });
        best
    }

    const fn is_enough(&self, found: &Found) -> bool {
        matches!(found, Ok((index, _)) if index.minimum.is_below(self.numbers.delta))
    }

    /// The largest of both over all times in their ranges.
    #[inline(never)]
    const fn over_ranges(
        &self,
        h: &Transfer,
        lagging: &Lagging,
        deviation: &Deviation,
        closeness: &Precision,
        and_needed: bool,
    ) -> Found {
        let period = self.numbers.period;
        let Some(times) = Times::of(lagging, period) else { return Err(UNKNOWN) };
        let mut all = Err(UNKNOWN);
        each!(index in 0..times.count() => {
            let part = times.part(index, period);
            each!(piece in 0..part.pieces() => {
                let Some(response) = &times.response(&part, piece) else { return Err(UNKNOWN) };
                let one = ok!(self.piece(h, response, deviation, closeness, and_needed));
                all = larger(one, all);
            });
        });
        all
    }

    /// The same over stored responses.
    const fn over_kept(
        &self,
        responses: &[SampledResponse],
        h: &Transfer,
        deviation: &Deviation,
        closeness: &Precision,
        and_needed: bool,
    ) -> Found {
        let mut all = Err(UNKNOWN);
        each!(i in 0..responses.len() => {
            let one = ok!(self.piece(h, &responses[i], deviation, closeness, and_needed));
            all = larger(one, all);
        });
        all
    }

    /// The sampled responses of this scene's times, for storage; `None` if it has no latency, or if a
    /// response is unknown.
    pub fn kept_responses<V: FromIterator<SampledResponse>>(&self) -> Option<KeptResponses<V>> {
        let (lagging, period) = (self.numbers.latency?, self.numbers.period);
        let times = Times::of(&lagging, period)?;
        let all = (0..times.count()).flat_map(|index| {
            let part = times.part(index, period);
            (0..part.pieces()).map(move |piece| times.response(&part, piece))
        });
        let responses = all.collect::<Option<V>>()?;
        Some(KeptResponses { latency: lagging.latency, period, responses })
    }

    /// [`PassivityProblem::answer`] with stored responses, which are ignored if they are for other times.
    pub fn answer_with<V: AsRef<[SampledResponse]>>(&self, kept: &KeptResponses<V>) -> RuleAnswer {
        let is_same = |lagging: &Lagging| {
            lagging.latency == kept.latency && self.numbers.period == kept.period
        };
        let reads_linearly = self.numbers.linearity.is_zero();
        if !reads_linearly || !self.numbers.latency.as_ref().is_some_and(is_same) {
            return self.answer();
        }
        self.answer_by(|closeness| {
            let (found, _) = self.over_proofs(Some(kept.responses.as_ref()), closeness, false)?;
            Ok(found)
        })
    }

    // Not inlined, so that the caller's frame is smaller.
    #[inline(never)]
    const fn piece(
        &self,
        h: &Transfer,
        response: &SampledResponse,
        deviation: &Deviation,
        closeness: &Precision,
        and_needed: bool,
    ) -> Found {
        let port = ok!(Port::new(h, response, self.numbers.period, deviation.ripple));
        let left = deviation.left;
        let delta = scaled(self.numbers.delta, left);
        let found = ok!(port.index_for(delta, &closeness.scaled(left)));
        let over_left = Interval::ONE.div(left);
        let index = RealPart { minimum: scaled(found.minimum, over_left), ..found };
        if !and_needed {
            return Ok((index, Interval::ENTIRE));
        }
        let needed = ok!(port.needed(delta.midpoint(), found));
        Ok((index, scaled(needed, over_left)))
    }

    /// The index of `E'` without latency, if the coupling has no memory.
    #[inline(never)]
    pub(super) const fn coupled_without_latency(&self) -> Option<Interval> {
        if self.numbers.is_matched {
            return None;
        }
        let Ok(found) = self.behind(self.numbers.excess_compliance(), &Precision::TIGHT) else {
            return None;
        };
        Some(found.minimum)
    }

    /// The whole controller.
    #[inline(never)]
    const fn at_the_port(&self) -> Result<(Transfer, &Lagging), IndexError> {
        let Some(lagging) = &self.numbers.latency else { return Err(UNKNOWN) };
        if self.has_no_transfer() {
            return Err(IndexError::Undecided(UndecidedReason::NoTransferFunction));
        }
        if self.numbers.misses_updates && lagging.matched.is_none() {
            return Err(IndexError::Undecided(UndecidedReason::MissedWithLatency));
        }
        match &self.numbers.behind_coupling(&cancelled(&self.environment)) {
            Ok(controller) => Ok((*controller, lagging)),
            Err(_) => Err(UNKNOWN),
        }
    }
}
