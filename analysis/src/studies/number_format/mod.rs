//! The effect of the number format on the servo's torque: the same servo in every format, on the same counts,
//! in the same hand.

mod advice;
mod cost;
mod friction;
mod limit_cycle;
mod losses;
mod motion;
mod units;

pub(crate) use advice::{Advice, Candidate, Requirements};
pub use cost::{Cost, cost};
pub(crate) use limit_cycle::{LimitCycle, at_rest};
pub(crate) use losses::Losses;
pub use motion::Motion;
pub use units::Units;

use haptic_servo::certificate::Resolution;
use haptic_servo::number::{Arithmetic, InEach, Number};
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

use crate::controller::{Controller, controller};
use crate::studies::error::StudyError;

/// Default of the largest angle in rad to each side of zero in a scaled format: that of a knob or a paddle.
pub const HALF_A_TURN: f64 = std::f64::consts::PI;

/// A scene with its sensor and motor, to be computed in any format.
#[derive(Clone, Copy, Debug)]
pub struct FormatProblem {
    /// The scene.
    pub scene: Scene,
    /// Its sensor and its motor.
    pub transducers: Transducers,
    /// The stated resolution, and the device's friction.
    pub steps: Resolution,
    /// Largest angle in rad to each side of zero in a scaled format.
    pub range: f64,
}

/// A servo from angles in rad to torques in N m, independently of its internal units.
pub struct FormatServo {
    controller: Box<dyn Controller>,
    units: Units,
}

impl FormatProblem {
    /// The units of a format's numbers in this scene.
    pub fn units(&self, arithmetic: Arithmetic) -> Units {
        if arithmetic.is_scaled() {
            let torque = self.scene.torque_limit.unwrap_or(self.transducers.full_scale_torque);
            Units::above(self.range, torque)
        } else {
            Units::SI
        }
    }

    /// The scene and its transducers in the units of a format.
    pub fn scaled(&self, arithmetic: Arithmetic) -> (Scene, Transducers) {
        let units = self.units(arithmetic);
        (units.scene(&self.scene), units.transducers(&self.transducers))
    }

    /// The scene's servo in a format, at rest at zero.
    pub fn servo(&self, arithmetic: Arithmetic) -> Result<FormatServo, StudyError> {
        let (scene, transducers) = self.scaled(arithmetic);
        let controller = arithmetic.choose(Build { scene, transducers })?;
        Ok(FormatServo { controller, units: self.units(arithmetic) })
    }
}

impl FormatServo {
    /// The torque in N m at a raw count, and the DAC's code.
    pub fn tick(&mut self, raw: i32) -> (f64, u16) {
        let tick = self.controller.tick(raw);
        (tick.torque * self.units.torque, tick.code)
    }

    /// The torque in N m at an exact angle in rad.
    pub fn tick_at(&mut self, angle: f64) -> Result<f64, StudyError> {
        Ok(self.controller.tick_at(angle / self.units.angle)? * self.units.torque)
    }
}

/// Builds a servo in a format selected at run time.
struct Build {
    scene: Scene,
    transducers: Transducers,
}

impl InEach for Build {
    type Output = Result<Box<dyn Controller>, StudyError>;

    fn with<N: Number>(self) -> Self::Output {
        let certified = self.scene.certify().map_err(StudyError::from)?;
        Ok(controller::<_, N>(&certified, &self.transducers)?)
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::environment::{Canceller, Environment, Parts, Rational, Side, Wall};
    use haptic_servo::scene::{Coupling, Device};

    use super::*;
    use crate::studies::failures::setting::{PADDLE, rational, rigid};

    /// Units are powers of two: the same bits come out, whatever a servo counts in.
    #[test]
    fn units_round_nothing() {
        let wall = Wall::damped(22.0, 0.01, 1).behind(0.01);
        let spring = Wall { side: Side::Displaced(0.01), ..Wall::spring(22.0, 1) }.alone();
        let undamped = Wall::damped(22.0, 0.0, 1).behind(0.01);
        let canceller = Some(Canceller::to(0.02));
        let rational = rational(&[13.0, -3.0], &[1.0, -0.3]);
        let rational = Rational { delay: 1, ..rational };
        for environment in [
            spring,
            wall.alone(),
            Canceller::to(0.002).alone(),
            Parts { canceller, wall: Some(undamped), ..Parts::NONE }.sum(),
            Environment::Rational(rational),
            crate::program::knob::SCENE.environment,
        ] {
            let scene = Scene {
                device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.021999) },
                coupling: Coupling::Spring { stiffness: 43.9 },
                torque_limit: (environment == spring).then_some(0.3),
                ..rigid(PADDLE, environment)
            };
            let transducers = Transducers::of(61_440.0, 0.7);
            let units = Units { angle: 4.0, torque: 0.25 };
            let build = |scene, transducers| Build { scene, transducers }.with::<f64>().unwrap();
            let mut plain = build(scene, transducers);
            let mut scaled = build(units.scene(&scene), units.transducers(&transducers));
            let mut count = 0;
            for tick in 0..500 {
                count += [3, -1, 40, -37, 2, -5][tick % 6];
                let (plain, scaled) = (plain.tick(count), scaled.tick(count));
                let torque = scaled.torque * units.torque;
                assert_eq!(plain.torque.to_bits(), torque.to_bits(), "{environment:?} {tick}");
                assert_eq!(plain.code, scaled.code, "{environment:?} {tick}");
            }
        }
    }

    #[test]
    fn units_hold_what_they_are_asked_to() {
        for (value, unit) in [(0.9, 1.0), (1.0, 2.0), (3.1, 4.0), (0.25, 0.5), (0.2, 0.25)] {
            assert_eq!(Units::above(value, value), Units { angle: unit, torque: unit });
        }
    }
}
