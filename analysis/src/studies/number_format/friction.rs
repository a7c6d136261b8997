//! The certificate's word on whether a device comes to rest, in any format.

use firmware::certificate::{QuantizationBound, Resolution};
use firmware::number::Arithmetic;

use super::FormatProblem;

impl FormatProblem {
    /// The most that encoder, converter and a format's numbers move the torque, in N m, and the
    /// device's friction against it (theory, section 8). `None` where nothing bounds it: the
    /// controller's response does not end.
    pub fn rest(&self, arithmetic: Arithmetic) -> Option<QuantizationBound> {
        // In the units that the servo counts in, since those are what it rounds.
        let units = self.units(arithmetic);
        let Resolution { encoder, full_scale, friction } = self.steps;
        let steps = Resolution {
            encoder: encoder.map(|step| step / units.angle),
            full_scale: full_scale.map(|torque| torque / units.torque),
            friction: friction.map(|torque| torque / units.torque),
        };
        let scene = units.scene(&self.scene);
        let QuantizationBound { encoder, numbers, converter, in_any_motion, .. } =
            QuantizationBound::of(&scene, arithmetic.format(), &steps)?;
        let in_newton_metres = |torque: f64| torque * units.torque;
        Some(QuantizationBound {
            encoder: encoder.map(in_newton_metres),
            numbers: in_newton_metres(numbers),
            converter: converter.map(in_newton_metres),
            friction,
            in_any_motion,
        })
    }
}
