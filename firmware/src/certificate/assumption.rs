//! What a verdict rests on: only what the scene uses.

use core::fmt;

use super::rules::{is_nonlinear, wall_of};
use crate::environment::Environment;
use crate::scene::Scene;

/// One thing that a certificate takes for granted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Assumption {
    /// A1 of theory, section 4.
    DevicePassivity {
        /// Declared passivity in N m s/rad.
        delta: f64,
    },
    /// A2 of theory, section 4.
    Hold {
        /// Longest time in s between two updates.
        longest: f64,
    },
    /// The delay is what the scene says.
    Delay {
        /// Whole samples.
        samples: usize,
    },
    /// The scene has no torque limit, so the converter must never saturate.
    NeverSaturates,
    /// The torque is limited between environment and coupling.
    Limited {
        /// Largest torque in N m.
        torque: f64,
    },
    /// The wall is felt on one side only.
    OneSided,
    /// The canceller removes damping that must be there.
    CancelledDamping {
        /// Declared device damping in N m s/rad.
        damping: f64,
    },
    /// Encoder and converter steps are outside the linear verdict.
    Quantisation,
}

impl fmt::Display for Assumption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DevicePassivity { delta } => write!(
                f,
                "whatever passive hand holds it, the device is output strictly passive from motor \
                 torque to velocity at the encoder with delta = {delta} N m s/rad"
            ),
            Self::Hold { longest } => write!(
                f,
                "position and torque belong to the same instant, the torque is held until the \
                 next, and no two updates are more than {longest} s apart"
            ),
            Self::Delay { samples } => {
                write!(f, "the environment is late by exactly {samples} whole sample(s)")
            }
            Self::NeverSaturates => {
                f.write_str("the torque never reaches the limit of motor or converter")
            }
            Self::Limited { torque } => write!(
                f,
                "torque limited to {torque} N m between environment and coupling; judged by the \
                 nonlinear bound"
            ),
            Self::OneSided => f.write_str("one-sided wall; judged by the nonlinear bound"),
            Self::CancelledDamping { damping } => write!(
                f,
                "the device really has the damping {damping} N m s/rad that is partly cancelled"
            ),
            Self::Quantisation => f.write_str(
                "encoder and converter steps are not part of the verdict: without friction of at \
                 least the torque of one step the device may hum at rest by that much",
            ),
        }
    }
}

/// The assumptions of a scene's verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumptions {
    all: [Option<Assumption>; 8],
}

impl Assumptions {
    /// Lists what the verdict on `scene` rests on.
    pub const fn of(scene: &Scene) -> Self {
        let delta = match scene.device.passivity {
            Some(passivity) => passivity,
            None => scene.device.damping,
        };
        let longest = match scene.timing.worst_period {
            Some(worst) => worst,
            None => scene.timing.period,
        };
        let limited = match scene.torque_limit {
            Some(torque) => Assumption::Limited { torque },
            None => Assumption::NeverSaturates,
        };
        let wall = wall_of(&scene.environment);
        let delay = match (&scene.environment, wall) {
            (_, Some(wall)) => wall.delay,
            (Environment::FreeMode { delay, .. }, _) => *delay,
            (Environment::Rational(rational), _) => rational.delay,
            _ => 0,
        };
        let cancels = matches!(
            scene.environment,
            Environment::FreeMode { .. } | Environment::FreeModeWall { .. }
        );
        let one_sided = is_nonlinear(scene) && matches!(wall, Some(w) if w.one_sided);
        let damping = scene.device.damping;
        Self {
            all: [
                Some(Assumption::DevicePassivity { delta }),
                Some(Assumption::Hold { longest }),
                if delay > 0 { Some(Assumption::Delay { samples: delay }) } else { None },
                if one_sided { Some(Assumption::OneSided) } else { None },
                Some(limited),
                if cancels { Some(Assumption::CancelledDamping { damping }) } else { None },
                Some(Assumption::Quantisation),
                None,
            ],
        }
    }

    /// The assumptions in order.
    pub fn iter(&self) -> impl Iterator<Item = &Assumption> {
        self.all.iter().flatten()
    }
}
