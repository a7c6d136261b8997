//! The winding, the reference model and the feedback, as numbers of one instant (theory, sections 15.1
//! and 15.2).

use core::f64::consts::TAU;

use super::motor::Motor;
use crate::passivity::interval::Interval;

/// Largest gain of the feedback: with it the loop has a double pole at 1/2, and with a smaller gain two real
/// poles, so that an error of the measurement is not amplified.
const LARGEST_FEEDBACK: f64 = 0.25;

/// Coefficients of one instant, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plant {
    /// `exp(-R h/L)`: the part of a current that remains.
    pub decay: f64,
    /// `(1 - a)/R`: current in A per volt.
    pub gain: f64,
    /// `1 - p` with `p = exp(-h/tau)`: the part of a step that the model makes in an instant.
    pub model_gain: f64,
    /// `K`, the gain of the feedback's loop.
    pub feedback: f64,
}

impl Plant {
    /// The coefficients for a motor and a model with this time constant in s, with instants of `instant` s.
    pub(super) const fn of(motor: &Motor, lag: f64, instant: f64) -> Self {
        let decay = exp_of_negative(motor.resistance * instant / motor.inductance);
        let model_gain = 1.0 - exp_of_negative(instant / lag);
        Self {
            decay,
            gain: (1.0 - decay) / motor.resistance,
            model_gain,
            feedback: model_gain.min(LARGEST_FEEDBACK),
        }
    }

    /// Largest voltage in V of the feed-forward in the step of a model from `-current` to `current` in A: at
    /// its beginning, for the inductance, or at its end, for the resistance.
    pub(super) const fn largest_voltage(&self, current: f64) -> f64 {
        let first = current * (self.decay - 1.0 + 2.0 * self.model_gain) / self.gain;
        let last = current * (1.0 - self.decay) / self.gain;
        first.max(last)
    }
}

/// Time constant in s of a bandwidth in Hz.
pub(super) const fn lag_of(bandwidth: f64) -> f64 {
    1.0 / (TAU * bandwidth)
}

/// `exp(-x)`.
const fn exp_of_negative(x: f64) -> f64 {
    Interval::exact(x).exp_of_negative().midpoint()
}
