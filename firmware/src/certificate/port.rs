//! The rule for linear scenes whose torque lags: equation 38 at the device's port.

use super::model::{Lagging, LoopIntervals};
use super::problem::PassivityProblem;
use crate::latency::TimeRange;
use crate::passivity::bernstein::Precision;
use crate::passivity::discrete::RealPart;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::{LagIntervals, Port};
use crate::passivity::poles::{IndexError, UndecidedReason, cancelled};
use crate::passivity::transfer::Transfer;

/// Parts into which the range of a time is cut that is not known exactly: the enclosure of each is
/// tighter than one of all together.
const PARTS: usize = 8;

/// The range of each time cut into parts.
#[derive(Clone, Copy)]
struct Cells {
    delay: TimeRange,
    actuator: TimeRange,
    sensor: TimeRange,
}

impl Cells {
    const fn of(lagging: &Lagging) -> Self {
        let latency = &lagging.latency;
        Self {
            delay: latency.output_delay,
            actuator: latency.actuator_lag,
            sensor: latency.sensor_lag,
        }
    }

    const fn count(&self) -> usize {
        parts(self.delay) * parts(self.actuator) * parts(self.sensor)
    }

    /// One of the cells, in periods.
    const fn cell(&self, index: usize, period: Interval) -> LagIntervals {
        let (delays, actuators) = (parts(self.delay), parts(self.actuator));
        LagIntervals {
            delay: part(self.delay, index % delays).div(period),
            lags: [
                part(self.actuator, index / delays % actuators).div(period),
                part(self.sensor, index / delays / actuators).div(period),
            ],
        }
    }
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

/// What a delay that deviates from tick to tick takes: passivity, and ripple over `T^2`
/// (theory, section 13.5).
#[derive(Clone, Copy)]
struct Deviation {
    /// What `D / 4` is divided by.
    divisor: Interval,
    /// What the index has to stay below.
    limit: Interval,
    ripple: Interval,
}

impl Deviation {
    const fn of(lagging: &Lagging, n: &LoopIntervals) -> Option<Self> {
        let latency = &lagging.latency;
        let none = Self { divisor: n.delta, limit: n.delta, ripple: Interval::ZERO };
        if latency.output_jitter == 0.0 {
            return Some(none);
        }
        if !latency.sensor_lag.is_zero() {
            return None;
        }
        let h = Interval::decimal(latency.output_jitter).div(n.period);
        if latency.actuator_lag.is_zero() {
            let limit = n.delta.mul(Interval::ONE.sub(h.half()));
            return Some(Self { limit, ripple: h.double().add(h), ..none });
        }
        let share = h.sqrt().half().midpoint();
        if !(share > 0.0 && share < 1.0) {
            return None;
        }
        let share = Interval::exact(share);
        let left = n.delta.mul(Interval::ONE.sub(share));
        Some(Self { divisor: left, limit: left, ripple: h.div(share) })
    }
}

/// What [`PassivityProblem::port_index`] has to stay below.
pub(super) const fn port_limit(lagging: &Lagging, n: &LoopIntervals) -> Interval {
    match Deviation::of(lagging, n) {
        Some(deviation) => deviation.limit,
        None => n.delta,
    }
}

const UNKNOWN: IndexError = IndexError::Undecided(UndecidedReason::OutOfRange);

impl PassivityProblem {
    /// The largest `-Re(H g) + D abs(H)^2 / (4 delta)`, which proves the scene if it is below
    /// [`port_limit`].
    #[inline(never)]
    pub(super) const fn port_index(&self, closeness: &Precision) -> Result<RealPart, IndexError> {
        let (h, lagging, deviation) = match self.at_the_port() {
            Ok(found) => found,
            Err(error) => return Err(error),
        };
        let mut found: Option<RealPart> = None;
        let mut index = 0;
        while index < Cells::of(&lagging).count() {
            let cell = Cells::of(&lagging).cell(index, self.numbers.period);
            let mut piece = 0;
            while piece < cell.pieces() {
                let one = match self.port(&h, &cell, piece, deviation.ripple) {
                    Ok(port) => port.index_for(deviation.divisor, closeness),
                    Err(error) => Err(error),
                };
                found = match (one, found) {
                    (Err(error), _) => return Err(error),
                    (Ok(one), None) => Some(one),
                    (Ok(one), Some(before)) => Some(RealPart {
                        minimum: one.minimum.max(before.minimum),
                        cos_theta: if one.minimum.hi() > before.minimum.hi() {
                            one.cos_theta
                        } else {
                            before.cos_theta
                        },
                    }),
                };
                piece += 1;
            }
            index += 1;
        }
        match found {
            Some(found) => Ok(found),
            None => Err(UNKNOWN),
        }
    }

    /// Index at the port with delay, lag and sensor, in N m s/rad: the least passivity of a device that
    /// would be enough. A delay that deviates from tick to tick is not counted.
    #[inline(never)]
    pub(super) const fn port_needed(&self) -> Result<Interval, IndexError> {
        let (h, lagging, _) = match self.at_the_port() {
            Ok(found) => found,
            Err(error) => return Err(error),
        };
        let mut found: Option<Interval> = None;
        let mut index = 0;
        while index < Cells::of(&lagging).count() {
            let cell = Cells::of(&lagging).cell(index, self.numbers.period);
            let mut piece = 0;
            while piece < cell.pieces() {
                let one = match self.port(&h, &cell, piece, Interval::ZERO) {
                    Ok(port) => port.needed(self.numbers.delta.midpoint()),
                    Err(error) => Err(error),
                };
                found = match (one, found) {
                    (Err(error), _) => return Err(error),
                    (Ok(one), None) => Some(one),
                    (Ok(one), Some(before)) => Some(one.max(before)),
                };
                piece += 1;
            }
            index += 1;
        }
        match found {
            Some(found) => Ok(found),
            None => Err(UNKNOWN),
        }
    }

    /// The index of `E'` without latency, where the coupling has no memory, and that at the port.
    #[inline(never)]
    pub(super) const fn coupled_and_at_port(&self) -> (Option<Interval>, Option<Interval>) {
        let coupled = if self.numbers.is_matched {
            None
        } else {
            match self.behind(self.numbers.excess_compliance(), &Precision::TIGHT) {
                Ok(found) => Some(found.minimum),
                Err(_) => None,
            }
        };
        match self.port_needed() {
            Ok(needed) => (coupled, Some(needed)),
            Err(_) => (coupled, None),
        }
    }

    #[inline(never)]
    const fn port(
        &self,
        h: &Transfer,
        cell: &LagIntervals,
        piece: usize,
        ripple: Interval,
    ) -> Result<Port, IndexError> {
        match cell.response(piece) {
            Some(response) => Port::new(h, &response, self.numbers.period, ripple),
            None => Err(UNKNOWN),
        }
    }

    /// The whole controller.
    #[inline(never)]
    const fn at_the_port(&self) -> Result<(Transfer, Lagging, Deviation), IndexError> {
        let Some(lagging) = self.numbers.latency else { return Err(UNKNOWN) };
        if self.has_no_transfer() {
            return Err(IndexError::Undecided(UndecidedReason::NoTransferFunction));
        }
        if self.numbers.misses_updates {
            return Err(IndexError::Undecided(UndecidedReason::MissedWithLatency));
        }
        let Some(deviation) = Deviation::of(&lagging, &self.numbers) else { return Err(UNKNOWN) };
        let controller = self.numbers.behind_coupling(&cancelled(&self.environment));
        match controller {
            Ok(controller) => Ok((controller, lagging, deviation)),
            Err(_) => Err(UNKNOWN),
        }
    }
}
