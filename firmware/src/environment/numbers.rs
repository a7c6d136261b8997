//! The numbers of any environment by name.

use super::any::Environment;
use crate::parameter::{NamedParameters, Parameter};

impl Environment {
    /// The value of a parameter, whole numbers included; `None` where it has none.
    pub const fn get(&self, parameter: Parameter) -> Option<f64> {
        let mut copy = *self;
        copy.read(parameter)
    }

    /// The same without a copy of the environment.
    pub(crate) const fn read(&mut self, parameter: Parameter) -> Option<f64> {
        match (parameter, &self) {
            (Parameter::Delay, _) => Some(*self.delay_mut() as f64),
            (Parameter::UnitZeros, Self::Rational(rational)) => Some(rational.unit_zeros as f64),
            _ => match self.number(parameter) {
                Some(value) => Some(*value),
                None => None,
            },
        }
    }

    /// The environment with this value; `None` if it has no such number. For a whole number the
    /// fraction of `value` is dropped.
    pub const fn with(&self, parameter: Parameter, value: f64) -> Option<Self> {
        let mut changed = *self;
        match (parameter, &mut changed) {
            (Parameter::Delay, _) => *changed.delay_mut() = value as usize,
            (Parameter::UnitZeros, Self::Rational(rational)) => {
                rational.unit_zeros = value as usize
            }
            (Parameter::Filter, _) => match changed.wall_mut() {
                Some(wall) => wall.filter = Some(value),
                None => return None,
            },
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
            (Parameter::StatedIndex, Self::Stated(stated)) => match &mut stated.bound {
                Some(bound) => Some(&mut bound.index),
                None => None,
            },
            (Parameter::StatedGain, Self::Stated(stated)) => match &mut stated.bound {
                Some(bound) => Some(&mut bound.gain),
                None => None,
            },
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
