//! The loss of passivity by a delay that deviates from tick to tick.

use super::loop_intervals::{Lagging, LoopIntervals};
use crate::passivity::interval::Interval;

/// The loss by a delay that deviates from tick to tick: passivity, and ripple over `T^2` (theory, section
/// 13.5).
#[derive(Clone, Copy)]
pub(super) struct Deviation {
    /// The divisor of `D / 4`.
    pub divisor: Interval,
    /// The upper bound on the index.
    pub limit: Interval,
    /// Ripple over `T^2`.
    pub ripple: Interval,
}

impl Deviation {
    /// `None` if no bound is known.
    pub const fn of(lagging: &Lagging, n: &LoopIntervals) -> Option<Self> {
        let latency = &lagging.latency;
        let none = Self { divisor: n.delta, limit: n.delta, ripple: Interval::ZERO };
        if latency.output_jitter == 0.0 {
            return Some(none);
        }
        if !latency.sensor_lag.is_zero() {
            return None;
        }
        let h = Interval::decimal(latency.output_jitter).div(n.period);
        if latency.actuator_lag.is_zero() && latency.actuator_response.is_zero() {
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

/// The upper bound on the index at the port of a scene whose torque lags.
pub(super) const fn port_limit(lagging: &Lagging, n: &LoopIntervals) -> Interval {
    match Deviation::of(lagging, n) {
        Some(deviation) => deviation.limit,
        None => n.delta,
    }
}
