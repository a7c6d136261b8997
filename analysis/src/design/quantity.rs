//! The numbers of an environment that a design takes as far as they go.

use firmware::parameter::Parameter;
use firmware::scene::Scene;

/// Unit of a delay.
pub const SAMPLES: &str = "samples";

/// A number of the environment that a design can take as far as it goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Quantity {
    /// Stiffness in N m/rad.
    Stiffness,
    /// Damping in N m s/rad.
    Damping,
    /// Delay in samples.
    Delay,
    /// Cancellation: the damping in N m s/rad that free mode takes away.
    Cancellation,
}

impl Quantity {
    /// Name and unit.
    pub fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::Stiffness => ("stiffness", "N m/rad"),
            Self::Damping => ("damping", "N m s/rad"),
            Self::Delay => ("delay", SAMPLES),
            Self::Cancellation => ("cancellation", "N m s/rad"),
        }
    }

    /// The scene with this much of it; `None` where its environment has no such number.
    pub(super) fn set(self, scene: &Scene, value: f64) -> Option<Scene> {
        match self {
            Self::Stiffness => scene.with(Parameter::Stiffness, value),
            Self::Damping => scene.with(Parameter::Damping, value),
            Self::Delay => scene.with(Parameter::Delay, value),
            Self::Cancellation => scene.with(Parameter::Residual, scene.device.damping - value),
        }
    }
}
