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
        let scaled = |torque: Option<f64>| torque.map(|torque| torque / units.torque);
        let Resolution { encoder, full_scale, friction, current, crossing } = self.steps;
        let steps = Resolution {
            encoder: encoder.map(|step| step / units.angle),
            full_scale: scaled(full_scale),
            friction: scaled(friction),
            current: scaled(current),
            crossing: scaled(crossing),
        };
        let scene = units.scene(&self.scene);
        let rest = QuantizationBound::of(&scene, arithmetic.format(), &steps)?;
        let in_newton_metres = |torque: f64| torque * units.torque;
        Some(QuantizationBound {
            encoder: rest.encoder.map(in_newton_metres),
            numbers: in_newton_metres(rest.numbers),
            converter: rest.converter.map(in_newton_metres),
            mean: in_newton_metres(rest.mean),
            motor: rest.motor.map(in_newton_metres),
            current,
            crossing,
            friction,
            ..rest
        })
    }
}
