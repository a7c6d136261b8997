//! The numbers of any environment by name.

use super::any::Environment;
use super::any_wall::Wall;
use super::composed::Composed;
use super::profile::{AnyProfile, Ends, ModeSelection};
use super::stated::{StatedBound, StatedModel};
use crate::parameter::{NamedParameters, Parameter, numbers};

impl Environment {
    /// The value of a parameter, including whole numbers; `None` if the environment does not have it.
    pub const fn get(&self, parameter: Parameter) -> Option<f64> {
        match (parameter, self.rational()) {
            (Parameter::Delay, Some(rational)) => Some(rational.delay as f64),
            (Parameter::Delay, None) => Some(self.delay() as f64),
            (Parameter::UnitZeros, Some(rational)) => Some(rational.unit_zeros as f64),
            _ => match self.number(parameter) {
                Some(value) => Some(*value),
                None => None,
            },
        }
    }

    /// The environment with this value; `None` if it does not have the parameter, or if a delay or a number
    /// of zeros is not a whole number in its range.
    pub const fn with(&self, parameter: Parameter, value: f64) -> Option<Self> {
        let mut changed = *self;
        let is_whole = parameter.range().admits(value);
        match (parameter, &mut changed) {
            (Parameter::Delay, _) if is_whole => *changed.delay_mut() = value as usize,
            (
                Parameter::UnitZeros,
                Self::Rational(rational) | Self::Stated(StatedModel::Linear(rational)),
            ) if is_whole => rational.unit_zeros = value as usize,
            (
                Parameter::Filter,
                Self::DamperWall(wall)
                | Self::FreeModeWall { wall, .. }
                | Self::Composed(Composed { wall: Some(wall), .. }),
            ) => {
                wall.filter = Some(value);
            }
            (Parameter::Mode, Self::Profile(profile)) => match profile.selecting(value) {
                Some(selected) => *profile = selected,
                None => return None,
            },
            _ => match changed.number_mut(parameter) {
                Some(place) => *place = value,
                None => return None,
            },
        }
        Some(changed)
    }

    numbers! {
        number, number_mut, numbers, value;
        Stiffness:
            Self::DelayedSpring(Wall { stiffness: value, .. })
            | Self::DamperWall(Wall { stiffness: value, .. })
            | Self::FreeModeWall { wall: Wall { stiffness: value, .. }, .. }
            | Self::Profile(AnyProfile { ends: Some(Ends { stiffness: value, .. }), .. })
            | Self::Composed(Composed { wall: Some(Wall { stiffness: value, .. }), .. })
            | Self::Composed(Composed {
                wall: None,
                profile: AnyProfile { ends: Some(Ends { stiffness: value, .. }), .. },
                ..
            }),
        // A spring ignores its wall's damping.
        Damping:
            Self::DamperWall(Wall { damping: value, .. })
            | Self::FreeModeWall { wall: Wall { damping: value, .. }, .. }
            | Self::Profile(AnyProfile { damping: value, .. })
            | Self::Composed(Composed { wall: Some(Wall { damping: value, .. }), .. })
            | Self::Composed(Composed { wall: None, profile: AnyProfile { damping: value, .. }, .. }),
        Filter:
            Self::DamperWall(Wall { filter: Some(value), .. })
            | Self::FreeModeWall { wall: Wall { filter: Some(value), .. }, .. }
            | Self::Composed(Composed { wall: Some(Wall { filter: Some(value), .. }), .. }),
        Face:
            Self::DelayedSpring(Wall { face: value, .. })
            | Self::DamperWall(Wall { face: value, .. })
            | Self::FreeModeWall { wall: Wall { face: value, .. }, .. }
            | Self::Composed(Composed { wall: Some(Wall { face: value, .. }), .. }),
        Residual:
            Self::FreeMode { residual: value, .. }
            | Self::FreeModeWall { residual: value, .. }
            | Self::Composed(Composed { residual: Some(value), .. }),
        StatedIndex:
            Self::Stated(StatedModel::Bounded { bound: StatedBound { index: value, .. }, .. }),
        ProfileTorque:
            Self::Profile(AnyProfile { torque: value, .. })
            | Self::Composed(Composed { profile: AnyProfile { torque: value, .. }, .. }),
        Count:
            Self::Profile(AnyProfile { count: value, .. })
            | Self::Composed(Composed { profile: AnyProfile { count: value, .. }, .. }),
        Centre:
            Self::Profile(AnyProfile { centre: value, .. })
            | Self::Composed(Composed { profile: AnyProfile { centre: value, .. }, .. }),
        From:
            Self::Profile(AnyProfile { ends: Some(Ends { from: value, .. }), .. })
            | Self::Composed(Composed {
                profile: AnyProfile { ends: Some(Ends { from: value, .. }), .. }, ..
            }),
        To:
            Self::Profile(AnyProfile { ends: Some(Ends { to: value, .. }), .. })
            | Self::Composed(Composed {
                profile: AnyProfile { ends: Some(Ends { to: value, .. }), .. }, ..
            }),
        Mode: Self::Profile(AnyProfile { modes: Some(ModeSelection { mode: value, .. }), .. }),
        StatedGain: Self::Stated(StatedModel::Bounded { bound: StatedBound { gain: value, .. }, .. }),
    }
}

impl NamedParameters for Environment {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.number_mut(parameter)
    }
}
