//! The certificate's bound for a device's coming to rest, in any format.

use haptic_servo::certificate::{QuantizationBound, Resolution};
use haptic_servo::number::Arithmetic;

use super::FormatProblem;

impl FormatProblem {
    /// Bound on the torque error of encoder, DAC and a format's numbers, in N m, and the device's
    /// friction against it (theory, section 8). `None` without a bound: the controller's impulse
    /// response is not summable.
    pub fn rest(&self, arithmetic: Arithmetic) -> Option<QuantizationBound> {
        // In the units of the servo, in which it rounds.
        let units = self.units(arithmetic);
        let Resolution { encoder, full_scale, friction, current, crossing } = self.steps;
        let steps = Resolution {
            encoder: encoder.map(|step| step / units.angle),
            full_scale: full_scale.map(|torque| torque / units.torque),
            friction: friction.map(|torque| torque / units.torque),
            current: current.map(|torque| torque / units.torque),
            crossing: crossing.map(|torque| torque / units.torque),
        };
        let scene = units.scene(&self.scene);
        let QuantizationBound { encoder, numbers, converter, mean, motor, in_any_motion, .. } =
            QuantizationBound::of(&scene, arithmetic.format(), &steps)?;
        let in_newton_metres = |torque: f64| torque * units.torque;
        Some(QuantizationBound {
            encoder: encoder.map(in_newton_metres),
            numbers: in_newton_metres(numbers),
            converter: converter.map(in_newton_metres),
            current,
            crossing,
            friction,
            mean: in_newton_metres(mean),
            motor: motor.map(in_newton_metres),
            in_any_motion,
        })
    }
}
