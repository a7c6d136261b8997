//! The numbers of any environment by name.

use super::anticogging::Anticogging;
use super::any::Environment;
use super::canceller::Canceller;
use super::drag::Drag;
use super::parts::Parts;
use super::profile::{Ends, ModeSelection, Profile};
use super::stated::{StatedBound, StatedModel};
use super::wall::{Damper, Side, Wall};
use crate::parameter::{NamedParameters, Parameter, numbers};

impl Environment {
    /// The value of a parameter, including whole numbers; `None` if the environment does not have it.
    pub const fn get(&self, parameter: Parameter) -> Option<f64> {
        match (parameter, self.rational(), self.wall()) {
            (Parameter::Delay, Some(rational), _) => Some(rational.delay as f64),
            (Parameter::Delay, None, _) => Some(self.delay() as f64),
            (Parameter::UnitZeros, Some(rational), _) => Some(rational.unit_zeros as f64),
            (Parameter::Face, _, Some(wall)) => Some(wall.face()),
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
            (Parameter::Delay, _) if is_whole => {
                match changed.delay_mut() {
                    Some(delay) => *delay = value as usize,
                    None => return None,
                }
                if let Self::Parts(parts) = &mut changed {
                    parts.align_drag();
                }
            }
            (
                Parameter::UnitZeros,
                Self::Rational(rational) | Self::Stated(StatedModel::Linear(rational)),
            ) if is_whole => rational.unit_zeros = value as usize,
            (
                Parameter::Filter,
                Self::Parts(Parts { wall: Some(Wall { damper: Some(damper), .. }), .. }),
            ) => damper.filter = Some(value),
            (Parameter::Face, Self::Parts(Parts { wall: Some(wall), .. })) => {
                wall.side = wall.side.at(value);
            }
            (Parameter::Mode, Self::Parts(Parts { profile: Some(profile), .. })) => {
                match profile.selecting(value) {
                    Some(selected) => *profile = selected,
                    None => return None,
                }
            }
            (Parameter::Drag, Self::Parts(parts)) if parts.drag.is_none() => {
                *parts = parts.with_drag(value);
            }
            _ => match changed.number_mut(parameter) {
                Some(place) => *place = value,
                None => return None,
            },
        }
        Some(changed)
    }

    /// The number of this name that may be changed while a program's servo runs; `None` if there is none. Of several
    /// modes it is only which of them is selected, because each has its own table, and a table that does not repeat
    /// stays in its place.
    pub(crate) const fn tunable_mut(&mut self, parameter: Parameter) -> Option<&mut f64> {
        use Parameter::{Centre, Count, Damping, From, ProfileTorque, Stiffness, To};
        let is_fixed = match self.profile() {
            Some(Profile { modes: Some(_), .. }) => match parameter {
                ProfileTorque | Count | Centre | From | To => true,
                Stiffness | Damping => self.wall().is_none(),
                _ => false,
            },
            Some(profile) => !profile.outline().wraps && matches!(parameter, Count | Centre),
            None => false,
        };
        if is_fixed { None } else { self.number_mut(parameter) }
    }

    numbers! {
        number, number_mut, numbers, value;
        Stiffness:
            Self::Parts(Parts { wall: Some(Wall { stiffness: value, .. }), .. })
            | Self::Parts(Parts {
                wall: None,
                profile: Some(Profile { ends: Some(Ends { stiffness: value, .. }), .. }),
                ..
            }),
        Damping:
            Self::Parts(Parts {
                wall: Some(Wall { damper: Some(Damper { damping: value, .. }), .. }), ..
            })
            | Self::Parts(Parts {
                wall: None, profile: Some(Profile { damping: Some(value), .. }), ..
            }),
        Filter:
            Self::Parts(Parts {
                wall: Some(Wall { damper: Some(Damper { filter: Some(value), .. }), .. }), ..
            }),
        Face:
            Self::Parts(Parts {
                wall: Some(Wall { side: Side::Displaced(value) | Side::Face(value), .. }), ..
            }),
        Residual: Self::Parts(Parts { canceller: Some(Canceller { residual: value, .. }), .. }),
        StatedIndex:
            Self::Stated(StatedModel::Bounded { bound: StatedBound { index: value, .. }, .. }),
        ProfileTorque: Self::Parts(Parts { profile: Some(Profile { torque: value, .. }), .. }),
        Count: Self::Parts(Parts { profile: Some(Profile { count: value, .. }), .. }),
        Centre: Self::Parts(Parts { profile: Some(Profile { centre: value, .. }), .. }),
        From:
            Self::Parts(Parts {
                profile: Some(Profile { ends: Some(Ends { from: value, .. }), .. }), ..
            }),
        To:
            Self::Parts(Parts {
                profile: Some(Profile { ends: Some(Ends { to: value, .. }), .. }), ..
            }),
        Mode:
            Self::Parts(Parts {
                profile: Some(Profile { modes: Some(ModeSelection { mode: value, .. }), .. }), ..
            }),
        Drag: Self::Parts(Parts { drag: Some(Drag { damping: value, .. }), .. }),
        Anticogging: Self::Parts(Parts { anticogging: Some(Anticogging { share: value, .. }), .. }),
        StatedGain: Self::Stated(StatedModel::Bounded { bound: StatedBound { gain: value, .. }, .. }),
    }
}

impl NamedParameters for Environment {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.number_mut(parameter)
    }
}
