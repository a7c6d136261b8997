//! The numbers of any environment by name.

use super::any::Environment;
use super::stated::StatedModel;
use crate::parameter::{NamedParameters, Parameter};

impl Environment {
    /// The value of a parameter, whole numbers included; `None` where it has none.
    pub const fn get(&self, parameter: Parameter) -> Option<f64> {
        let mut copy = *self;
        copy.read(parameter)
    }

    /// The same without a copy of the environment.
    pub(crate) const fn read(&mut self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::Delay => Some(*self.delay_mut() as f64),
            Parameter::UnitZeros => match self.rational() {
                Some(rational) => Some(rational.unit_zeros as f64),
                None => None,
            },
            _ => match self.number(parameter) {
                Some(value) => Some(*value),
                None => None,
            },
        }
    }

    /// The environment with this value; `None` where there is no place for it, and for a delay or a
    /// number of zeros that is no whole number in its range.
    pub const fn with(&self, parameter: Parameter, value: f64) -> Option<Self> {
        let mut changed = *self;
        let is_whole = parameter.range().admits(value);
        match (parameter, &mut changed) {
            (Parameter::Delay, _) if is_whole => *changed.delay_mut() = value as usize,
            (
                Parameter::UnitZeros,
                Self::Rational(rational) | Self::Stated(StatedModel::Linear(rational)),
            ) if is_whole => rational.unit_zeros = value as usize,
            (Parameter::Filter, Self::DamperWall(wall) | Self::FreeModeWall { wall, .. }) => {
                wall.filter = Some(value);
            }
            _ => match changed.number(parameter) {
                Some(place) => *place = value,
                None => return None,
            },
        }
        Some(changed)
    }

    /// The number of this name, unless it is a whole number.
    const fn number(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match (parameter, self) {
            // A spring ignores its wall's damping.
            (Parameter::Damping | Parameter::Filter, Self::DelayedSpring(_)) => None,
            (
                Parameter::Residual,
                Self::FreeMode { residual, .. } | Self::FreeModeWall { residual, .. },
            ) => Some(residual),
            (Parameter::StatedIndex, Self::Stated(StatedModel::Bounded { bound, .. })) => {
                Some(&mut bound.index)
            }
            (Parameter::StatedGain, Self::Stated(StatedModel::Bounded { bound, .. })) => {
                Some(&mut bound.gain)
            }
            (_, environment) => match environment.wall_mut() {
                Some(wall) => wall.number(parameter),
                None => None,
            },
        }
    }
}

impl NamedParameters for Environment {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.number(parameter)
    }
}
