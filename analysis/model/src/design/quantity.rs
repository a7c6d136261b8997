//! The numbers of a scene that a design takes to their limit.

use haptic_servo::latency::{LONGEST_DELAY, LONGEST_LAG};
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::Scene;

/// Unit of a delay.
pub const SAMPLES: &str = "samples";

/// A number of a scene that a design can take to its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Quantity {
    /// Stiffness in N m/rad.
    Stiffness,
    /// Damping in N m s/rad.
    Damping,
    /// Delay in samples.
    Delay,
    /// Cancellation: the damping in N m s/rad that free mode takes away.
    Cancellation,
    /// Time constant in s of the amplifier: that of the slowest current loop.
    ActuatorLag,
    /// Time in s from a count to its torque: the longest latency.
    OutputDelay,
    /// Torque in N m of a torque profile: the strongest detents.
    Torque,
    /// Repetitions of a torque profile in a turn: the most detents.
    Count,
}

impl Quantity {
    /// Name and unit.
    pub fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::Cancellation => ("cancellation", "N m s/rad"),
            _ => self.parameter().name_and_unit(),
        }
    }

    /// The number of the scene that it sets.
    fn parameter(self) -> Parameter {
        match self {
            Self::Stiffness => Parameter::Stiffness,
            Self::Damping => Parameter::Damping,
            Self::Delay => Parameter::Delay,
            Self::Cancellation => Parameter::Residual,
            Self::ActuatorLag => Parameter::ActuatorLag,
            Self::OutputDelay => Parameter::OutputDelay,
            Self::Torque => Parameter::ProfileTorque,
            Self::Count => Parameter::Count,
        }
    }

    /// The scene with this value of the quantity; `None` where its environment has no such number.
    pub(crate) fn set(self, scene: &Scene, value: f64) -> Option<Scene> {
        match self {
            Self::Cancellation => scene.with(Parameter::Residual, scene.device.damping - value),
            // A profile that does not repeat has no number of repetitions.
            Self::Count if !scene.environment.profile()?.outline().wraps => None,
            Self::OutputDelay => {
                let value = last_update(scene, value) + scene.latency.encoder.age.middle();
                let mut delayed = scene.with(Parameter::OutputDelay, value)?;
                let largest = delayed.largest_jitter();
                let latency = &mut delayed.latency;
                latency.output_jitter = latency.output_jitter.min(largest);
                if latency.total_jitter() > largest {
                    // Below the difference, so that the sum does not round up.
                    latency.count_jitter = (largest - latency.output_jitter).next_down().max(0.0);
                }
                Some(delayed)
            }
            _ => scene.with(self.parameter(), value),
        }
    }

    /// The value that a scene has after it was set to `value`: where the amplifier is updated N times in a
    /// period, an output delay becomes that of the last update before it.
    pub(super) fn reached(self, scene: &Scene, value: f64) -> f64 {
        match self {
            Self::OutputDelay => last_update(scene, value),
            _ => value,
        }
    }

    /// The least value that a scene may have: 0, nearly 0 for a torque, or 1 for a number of repetitions.
    pub(super) fn least(self) -> f64 {
        match self {
            Self::Torque => 1e-12,
            Self::Count => 1.0,
            _ => 0.0,
        }
    }

    /// Whether it is a whole number.
    pub(super) fn is_whole(self) -> bool {
        matches!(self, Self::Delay | Self::Count)
    }

    /// The largest value that a scene of this period in s, and a DAC of this full scale in N m, may have,
    /// apart from its certificate; `None` where there is no such bound.
    pub(super) fn largest(self, period: f64, full_scale: Option<f64>) -> Option<f64> {
        match self {
            Self::Torque => full_scale,
            Self::ActuatorLag => Some(LONGEST_LAG * period),
            Self::OutputDelay => Some(LONGEST_DELAY * period),
            _ => None,
        }
    }
}

/// The last update of a scene's amplifier up to `time`, in s; `time` itself if the amplifier is continuous.
fn last_update(scene: &Scene, time: f64) -> f64 {
    /// Relative rounding of a whole number of updates, from its decimals.
    const ROUNDING: f64 = 1e-9;
    let (period, latency) = (scene.timing.period, &scene.latency);
    if latency.actuator_updates == 0 {
        return time;
    }
    let age = latency.encoder.age.middle();
    let updates = (time - age) / period * f64::from(latency.actuator_updates);
    latency.delay_at_update((updates * (1.0 + ROUNDING)) as u32, period) + age
}
