//! Environments as sums of parts, all at the same position `x_E`: a canceller of the device's damping, a wall
//! and a torque profile, each of them at most once.
//!
//! Their passivity indices add, with a torque limit on the sum as well (theory, section 14.3). In a sum the
//! profile is late by at least one sample, because an undelayed profile is solved in front of the coupling,
//! and the canceller is not late. A wall is at one angle of many turns, so the profile beside it must have end
//! stops.
//!
//! If parts have parameters of the same name, `stiffness`, `damping` and `face` are the wall's; `torque`,
//! `count`, `centre`, `from`, `to` and `delay` the profile's; `residual` the canceller's. Without a wall,
//! `stiffness` is that of the end stops.

use super::canceller::Canceller;
use super::profile::Profile;
use super::wall::Wall;

/// The parts of an environment, whose torques add.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Parts {
    /// Cancels the device's damping.
    pub canceller: Option<Canceller>,
    /// A wall.
    pub wall: Option<Wall>,
    /// A torque profile.
    pub profile: Option<Profile>,
}

impl Parts {
    /// No part: no torque.
    pub const NONE: Self = Self { canceller: None, wall: None, profile: None };

    /// The number of parts.
    pub const fn count(&self) -> usize {
        self.canceller.is_some() as usize
            + self.wall.is_some() as usize
            + self.profile.is_some() as usize
    }

    /// Whether a part is late by at least one sample, and no part is not.
    pub const fn is_late(&self) -> bool {
        self.count() > 0
            && !matches!(self.canceller, Some(Canceller { delay: 0, .. }))
            && !matches!(self.wall, Some(Wall { delay: 0, .. }))
            && !matches!(self.profile, Some(Profile { delay: 0, .. }))
    }

    /// The delay in whole samples: the profile's, else the wall's, else the canceller's.
    pub(super) const fn delay(&self) -> usize {
        match self {
            Self { profile: Some(profile), .. } => profile.delay,
            Self { wall: Some(wall), .. } => wall.delay,
            Self { canceller: Some(canceller), .. } => canceller.delay,
            Self { canceller: None, wall: None, profile: None } => 0,
        }
    }

    /// The same, mutable; `None` without parts.
    pub(super) const fn delay_mut(&mut self) -> Option<&mut usize> {
        match self {
            Self { profile: Some(profile), .. } => Some(&mut profile.delay),
            Self { wall: Some(wall), .. } => Some(&mut wall.delay),
            Self { canceller: Some(canceller), .. } => Some(&mut canceller.delay),
            Self { canceller: None, wall: None, profile: None } => None,
        }
    }
}
