//! Proofs for linear scenes whose delay deviates from tick to tick.

use super::loop_intervals::{Lagging, LoopIntervals};
use crate::latency::Latency;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::{SampledResponse, ripple_of_mixture};
use crate::response_window::ResponseWindow;
use crate::scene::Timing;

/// A condition of the form of equation 38 that proves a linear scene: for a device that has only a part of
/// its passivity left, with more ripple, or with another sampled response.
#[derive(Clone, Copy)]
pub(super) struct Deviation {
    /// The part of the passivity that is left.
    pub left: Interval,
    /// The added ripple over `T^2`.
    pub ripple: Interval,
    /// The sampled response in place of those of the scene's delays and lags.
    pub response: Option<SampledResponse>,
}

impl Deviation {
    /// The number of proofs; each alone is enough.
    pub const COUNT: usize = 3;

    /// Whether at most one of the proofs covers the scene.
    pub const fn is_alone(lagging: &Lagging, n: &LoopIntervals) -> bool {
        let latency = &lagging.latency;
        n.linearity.is_zero() && is_constant(latency, n) && !has_window_besides(latency)
    }

    const NONE: Self = Self { left: Interval::ONE, ripple: Interval::ZERO, response: None };

    /// One of the proofs; `None` if it does not cover the scene.
    pub const fn of(proof: usize, lagging: &Lagging, n: &LoopIntervals) -> Option<Self> {
        let latency = &lagging.latency;
        if is_constant(latency, n) {
            return match proof {
                0 if n.linearity.is_zero() => Some(Self::NONE),
                0 => Some(Self::through_inl(lagging, n)),
                1 if has_window_besides(latency) => Self::within_window(lagging, n),
                _ => None,
            };
        }
        let h = Interval::decimal(latency.total_jitter()).div(n.period);
        // A jitter of counts is one of torques with the lags of amplifier and sensor exchanged. For both at
        // once only the window is proved.
        let is_of_pulses =
            latency.sensor_lag.is_zero() && !latency.jitters_twice() && !n.misses_updates;
        match proof {
            0 => Self::within_window(lagging, n),
            1 if is_of_pulses && h.hi() <= 0.5 => Some(Self::of_means(h)),
            2 if is_of_pulses && h.hi() <= 1.0 => Some(Self::of_work(h)),
            _ => None,
        }
    }

    /// Through a nonlinear encoder the ripple is `1 + eta` times that of the delay (equation 66).
    const fn through_inl(lagging: &Lagging, n: &LoopIntervals) -> Self {
        let delay = Interval::decimal(lagging.latency.output_delay.most).div(n.period);
        Self { ripple: n.linearity.mul(ripple_of_mixture(delay, delay)), ..Self::NONE }
    }

    /// All torques lie in a window (theory, equation 57).
    #[inline(never)]
    const fn within_window(lagging: &Lagging, n: &LoopIntervals) -> Option<Self> {
        // Only with a matched coupling is it known that no torque is latched across a missed update.
        if n.misses_updates && lagging.matched.is_none() {
            return None;
        }
        let Lagging { latency, timing: Timing { period, worst_period }, .. } = lagging;
        let Some(window) = ResponseWindow::of::<true>(*period, *worst_period, latency) else {
            return None;
        };
        match window.response() {
            Some(response) => Some(Self {
                left: window.between_counts.div(window.width),
                ripple: Interval::ZERO,
                response: Some(response),
            }),
            None => None,
        }
    }

    /// Only the means of the ticks change, and their ripples (equation 58 with `mu = 1`).
    const fn of_means(h: Interval) -> Self {
        let root = Interval::exact(2.0).sqrt();
        let left = Interval::ONE.sub(h.div(root));
        let ripple = h.mul(root.double().double().add(Interval::ONE));
        Self { left, ripple: ripple.mul(left), response: None }
    }

    /// The work of the pulses by which the torque differs (equation 42 with `s = delta sqrt(h)`).
    const fn of_work(h: Interval) -> Self {
        let share = Interval::exact(h.sqrt().half().midpoint());
        let left = Interval::ONE.sub(share);
        Self { left, ripple: h.mul(left).div(share), response: None }
    }
}

/// Whether no time deviates from tick to tick.
const fn is_constant(latency: &Latency, n: &LoopIntervals) -> bool {
    latency.total_jitter() == 0.0 && !n.misses_updates
}

/// Whether the window may prove more than constant times do. The ripple of an amplifier of no known shape is that of
/// the worst, and the window may be better. Updates beside a sensor filter are known within a window only.
const fn has_window_besides(latency: &Latency) -> bool {
    !latency.actuator_response.is_zero() || latency.is_filtered_beside_updates()
}
