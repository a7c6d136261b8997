//! The numbers of a scene by name, and the range in which each makes sense at all.

use crate::environment::{Environment, MAX_DELAY, Rational, Wall};
use crate::scene::{Coupling, Scene};
use crate::text::Text;

/// A number of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Parameter {
    /// `device.inertia`
    Inertia,
    /// `device.damping`
    DeviceDamping,
    /// `device.passivity`
    Passivity,
    /// `servo.period`
    Period,
    /// `servo.worst_period`
    WorstPeriod,
    /// `coupling.stiffness`
    CouplingStiffness,
    /// `environment.stiffness`
    Stiffness,
    /// `environment.damping`
    Damping,
    /// `environment.filter`
    Filter,
    /// `environment.delay`
    Delay,
    /// `environment.face`
    Face,
    /// `environment.residual`
    Residual,
    /// `environment.numerator`
    Numerator,
    /// `environment.denominator`
    Denominator,
    /// `environment.unit_zeros`
    UnitZeros,
    /// `limits.torque`
    TorqueLimit,
}

impl Parameter {
    /// Name and unit for sentences.
    pub const fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::Inertia => ("device inertia", "kg m^2"),
            Self::DeviceDamping => ("device damping", "N m s/rad"),
            Self::Passivity => ("device passivity", "N m s/rad"),
            Self::Period => ("period", "s"),
            Self::WorstPeriod => ("worst period", "s"),
            Self::CouplingStiffness => ("coupling stiffness", "N m/rad"),
            Self::Stiffness => ("stiffness", "N m/rad"),
            Self::Damping => ("damping", "N m s/rad"),
            Self::Filter => ("filter", ""),
            Self::Delay => ("delay", "samples"),
            Self::Face => ("face", "rad"),
            Self::Residual => ("residual", "N m s/rad"),
            Self::Numerator => ("numerator coefficient", ""),
            Self::Denominator => ("denominator coefficient", ""),
            Self::UnitZeros => ("number of zeros at 1", ""),
            Self::TorqueLimit => ("torque limit", "N m"),
        }
    }
}

/// A number that makes no sense whatever the rest of the scene is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidParameter {
    /// Which number.
    pub parameter: Parameter,
    /// Its value.
    pub value: f64,
    /// What it has to be.
    pub bound: &'static str,
    /// The number of the scene that `bound` ends in, in the same unit; `None` where it says all.
    pub limit: Option<f64>,
}

impl InvalidParameter {
    /// "the period is 0 s, and must be finite and greater than 0"
    pub(super) const fn write<const N: usize>(&self, text: &mut Text<N>) {
        let (name, unit) = self.parameter.name_and_unit();
        text.push("the ");
        text.push(name);
        text.push(" is ");
        text.push_number(self.value);
        if !unit.is_empty() {
            text.push(" ");
            text.push(unit);
        }
        text.push(", and must be ");
        text.push(self.bound);
        if let Some(limit) = self.limit {
            text.push(" ");
            text.push_number(limit);
            text.push(" ");
            text.push(unit);
        }
    }
}

const POSITIVE: &str = "finite and greater than 0";
const NOT_NEGATIVE: &str = "finite and not below 0";
const FINITE: &str = "finite";
/// In a free hand, the slower the device moves, the nearer `Re(1/J)` comes to its damping.
const NO_MORE_THAN_DAMPING: &str =
    "finite and at most the device damping, which no device's passivity exceeds:";

/// The first number of the scene that is out of its range.
pub(super) const fn first_invalid(scene: &Scene) -> Option<InvalidParameter> {
    let mut check = Check { found: None };
    let device = &scene.device;
    check.positive(Parameter::Inertia, device.inertia);
    check.not_negative(Parameter::DeviceDamping, device.damping);
    if let Some(passivity) = device.passivity {
        check.finite(Parameter::Passivity, passivity);
        check.at_most(Parameter::Passivity, passivity, device.damping, NO_MORE_THAN_DAMPING);
    }
    check.positive(Parameter::Period, scene.timing.period);
    if let Some(worst) = scene.timing.worst_period {
        let fits = worst.is_finite() && worst >= scene.timing.period;
        check.that(fits, Parameter::WorstPeriod, worst, "finite and not below the period");
    }
    if let Coupling::Spring { stiffness } = scene.coupling {
        check.positive(Parameter::CouplingStiffness, stiffness);
    }
    check.environment(&scene.environment);
    if let Some(limit) = scene.torque_limit {
        check.positive(Parameter::TorqueLimit, limit);
    }
    check.found
}

struct Check {
    found: Option<InvalidParameter>,
}

impl Check {
    const fn that(&mut self, fits: bool, parameter: Parameter, value: f64, bound: &'static str) {
        if !fits && self.found.is_none() {
            self.found = Some(InvalidParameter { parameter, value, bound, limit: None });
        }
    }

    /// `bound` ends in the limit.
    const fn at_most(&mut self, parameter: Parameter, value: f64, limit: f64, bound: &'static str) {
        if value > limit && self.found.is_none() {
            self.found = Some(InvalidParameter { parameter, value, bound, limit: Some(limit) });
        }
    }

    const fn positive(&mut self, parameter: Parameter, value: f64) {
        self.that(value.is_finite() && value > 0.0, parameter, value, POSITIVE);
    }

    const fn not_negative(&mut self, parameter: Parameter, value: f64) {
        self.that(value.is_finite() && value >= 0.0, parameter, value, NOT_NEGATIVE);
    }

    const fn finite(&mut self, parameter: Parameter, value: f64) {
        self.that(value.is_finite(), parameter, value, FINITE);
    }

    const fn environment(&mut self, environment: &Environment) {
        match environment {
            Environment::DelayedSpring(wall) | Environment::DamperWall(wall) => self.wall(wall),
            Environment::FreeMode { residual, delay } => {
                self.finite(Parameter::Residual, *residual);
                self.delay(*delay);
            }
            Environment::FreeModeWall { residual, wall } => {
                self.finite(Parameter::Residual, *residual);
                self.wall(wall);
            }
            Environment::Rational(rational) => self.rational(rational),
        }
    }

    const fn wall(&mut self, wall: &Wall) {
        self.finite(Parameter::Stiffness, wall.stiffness);
        self.finite(Parameter::Damping, wall.damping);
        if let Some(a) = wall.filter {
            self.that(a >= 0.0 && a < 1.0, Parameter::Filter, a, "at least 0 and below 1");
        }
        self.finite(Parameter::Face, wall.face);
        self.delay(wall.delay);
    }

    const fn delay(&mut self, delay: usize) {
        self.that(delay <= MAX_DELAY, Parameter::Delay, delay as f64, "a whole number up to 8");
    }

    const fn rational(&mut self, rational: &Rational) {
        self.coefficients(Parameter::Numerator, rational.numerator.as_slice());
        self.coefficients(Parameter::Denominator, rational.denominator.as_slice());
        let zeros = rational.unit_zeros;
        self.that(zeros <= 8, Parameter::UnitZeros, zeros as f64, "a whole number up to 8");
        self.delay(rational.delay);
    }

    const fn coefficients(&mut self, parameter: Parameter, values: &[f64]) {
        let mut i = 0;
        while i < values.len() {
            self.finite(parameter, values[i]);
            i += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Rejection, certify};
    use crate::environment::Environment;
    use crate::scene::{Device, Timing};

    fn with_passivity(passivity: f64) -> Result<(), Rejection> {
        let wall = Wall {
            stiffness: 21.0,
            damping: 0.0,
            delay: 1,
            filter: None,
            face: 0.0,
            one_sided: false,
        };
        let scene = Scene {
            device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(passivity) },
            timing: Timing { period: 0.001, worst_period: None },
            coupling: Coupling::Spring { stiffness: 44.0 },
            environment: Environment::DelayedSpring(wall),
            torque_limit: None,
        };
        certify(&scene).map(|_| ())
    }

    #[test]
    fn no_device_has_more_passivity_than_damping() {
        assert_eq!(with_passivity(0.022), Ok(()));
        for passivity in [0.022_f64.next_up(), 0.22, f64::MAX] {
            let refused = with_passivity(passivity).unwrap_err();
            assert!(matches!(refused, Rejection::Invalid(_)), "{refused:?}");
        }
        assert_eq!(
            with_passivity(0.22).unwrap_err().sentence().as_str(),
            "rejected: the device passivity is 0.22 N m s/rad, and must be finite and at most the \
             device damping, which no device's passivity exceeds: 0.022 N m s/rad"
        );
        // What is no passivity at all keeps the reason that it had.
        for passivity in [0.0, -1.0] {
            let refused = with_passivity(passivity).unwrap_err();
            assert!(matches!(refused, Rejection::NoPassivity { .. }), "{refused:?}");
        }
        let infinite = with_passivity(f64::INFINITY).unwrap_err().sentence();
        assert!(infinite.as_str().ends_with("must be finite"), "{}", infinite.as_str());
    }
}
