//! Units of angle and torque: how a scene fits a format that holds nothing above 1.

use firmware::environment::{Coefficients, Environment, Rational, Wall};
use firmware::scene::{Coupling, Device, Scene};
use firmware::servo::Transducers;

/// What a servo's numbers count. Powers of two, so that a change of units rounds nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Unit of angles in rad.
    pub angle: f64,
    /// Unit of torques in N m.
    pub torque: f64,
}

impl Units {
    /// rad and N m.
    pub const SI: Self = Self { angle: 1.0, torque: 1.0 };

    /// The smallest in which an angle in rad and a torque in N m are below 1.
    pub fn above(angle: f64, torque: f64) -> Self {
        let above = |value: f64| (value.log2().floor() + 1.0).exp2();
        Self { angle: above(angle), torque: above(torque) }
    }

    /// The same scene in these units.
    pub fn scene(&self, scene: &Scene) -> Scene {
        let stiffness = self.angle / self.torque;
        let Device { inertia, damping, passivity } = scene.device;
        Scene {
            device: Device {
                inertia: inertia * stiffness,
                damping: damping * stiffness,
                passivity: passivity.map(|passivity| passivity * stiffness),
            },
            timing: scene.timing,
            coupling: match scene.coupling {
                Coupling::Rigid => Coupling::Rigid,
                Coupling::Spring { stiffness: k } => Coupling::Spring { stiffness: k * stiffness },
            },
            environment: self.environment(scene.environment),
            torque_limit: scene.torque_limit.map(|limit| limit / self.torque),
        }
    }

    /// The same sensor and motor in these units.
    pub fn transducers(&self, transducers: &Transducers) -> Transducers {
        Transducers {
            // A turn has fewer units than rad, and a unit as many times more counts.
            counts_per_turn: transducers.counts_per_turn * self.angle,
            counter: transducers.counter,
            full_scale_torque: transducers.full_scale_torque / self.torque,
            largest_speed: transducers.largest_speed / self.angle,
        }
    }

    fn environment(&self, environment: Environment) -> Environment {
        let residual = |residual: f64| residual * self.angle / self.torque;
        match environment {
            Environment::DelayedSpring(wall) => Environment::DelayedSpring(self.wall(wall)),
            Environment::DamperWall(wall) => Environment::DamperWall(self.wall(wall)),
            Environment::FreeMode { residual: left, delay } => {
                Environment::FreeMode { residual: residual(left), delay }
            }
            Environment::FreeModeWall { residual: left, wall } => {
                Environment::FreeModeWall { residual: residual(left), wall: self.wall(wall) }
            }
            Environment::Rational(rational) => {
                let scaled: Vec<_> =
                    rational.numerator.as_slice().iter().map(|n| residual(*n)).collect();
                let numerator = Coefficients::new(&scaled).unwrap_or(rational.numerator);
                Environment::Rational(Rational { numerator, ..rational })
            }
        }
    }

    fn wall(&self, wall: Wall) -> Wall {
        let stiffness = self.angle / self.torque;
        Wall {
            stiffness: wall.stiffness * stiffness,
            damping: wall.damping * stiffness,
            face: wall.face / self.angle,
            ..wall
        }
    }
}
