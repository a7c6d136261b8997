//! The numbers of an environment that a design takes as far as they go.

use firmware::environment::{Environment, Wall};
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
        let mut changed = *scene;
        match (self, &mut changed.environment) {
            (Self::Cancellation, Environment::FreeMode { residual, .. })
            | (Self::Cancellation, Environment::FreeModeWall { residual, .. }) => {
                *residual = scene.device.damping - value;
            }
            (Self::Delay, Environment::FreeMode { delay, .. }) => *delay = value as usize,
            (Self::Delay, Environment::Rational(rational)) => rational.delay = value as usize,
            (_, environment) => self.set_wall(wall_of(environment)?, value)?,
        }
        Some(changed)
    }

    fn set_wall(self, wall: &mut Wall, value: f64) -> Option<()> {
        match self {
            Self::Stiffness => wall.stiffness = value,
            Self::Damping => wall.damping = value,
            Self::Delay => wall.delay = value as usize,
            Self::Cancellation => return None,
        }
        Some(())
    }
}

fn wall_of(environment: &mut Environment) -> Option<&mut Wall> {
    match environment {
        Environment::DelayedSpring(wall)
        | Environment::DamperWall(wall)
        | Environment::FreeModeWall { wall, .. } => Some(wall),
        Environment::FreeMode { .. } | Environment::Rational(_) => None,
    }
}
