//! Units of angle and torque, which scale a scene to a format with a range of 1.

use haptic_servo::environment::{Coefficients, Environment};
use haptic_servo::parameter::{NamedParameters, Parameter};
use haptic_servo::scene::{Device, Scene};
use haptic_servo::servo::Transducers;

/// The units of a servo's numbers: powers of two, so that a change of units is exact.
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

    /// The smallest units in which an angle in rad and a torque in N m are below 1.
    pub fn above(angle: f64, torque: f64) -> Self {
        let above = |value: f64| (value.log2().floor() + 1.0).exp2();
        Self { angle: above(angle), torque: above(torque) }
    }

    /// The same scene in these units.
    pub fn scene(&self, scene: &Scene) -> Scene {
        // N m/rad, and N m s/rad and kg m^2 as well.
        let slope = |value: f64| value * self.angle / self.torque;
        let mut scene = *scene;
        for &parameter in Parameter::ALL {
            let Some(number) = scene.value(parameter) else { continue };
            *number = match (parameter, parameter.name_and_unit().1) {
                // A turn has fewer units.
                (Parameter::Count, _) => *number * self.angle,
                (_, "rad") => *number / self.angle,
                (_, "N m") => *number / self.torque,
                (_, "N m/rad" | "N m s/rad") => slope(*number),
                _ => *number,
            };
        }
        let Device { inertia, damping, passivity } = scene.device;
        let (inertia, damping) = (slope(inertia), slope(damping));
        scene.device = Device { inertia, damping, passivity: passivity.map(slope) };
        if let Environment::Rational(rational) = &mut scene.environment {
            let scaled: Vec<_> = rational.numerator.as_slice().iter().map(|n| slope(*n)).collect();
            rational.numerator = Coefficients::new(&scaled).unwrap_or(rational.numerator);
        }
        scene
    }

    /// The same sensor and motor in these units.
    pub fn transducers(&self, transducers: &Transducers) -> Transducers {
        Transducers {
            // A turn has fewer units than rad, and a unit more counts by the same factor.
            counts_per_turn: transducers.counts_per_turn * self.angle,
            counter: transducers.counter,
            full_scale_torque: transducers.full_scale_torque / self.torque,
            largest_speed: transducers.largest_speed / self.angle,
        }
    }
}
