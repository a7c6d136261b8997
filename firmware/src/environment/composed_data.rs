//! Sums of typed environments as data.

use super::any::Environment;
use super::composed::{Composed, FreeModeProfile, FreeModeWallAndProfile, WallAndProfile};
use super::profile::Profile;
use super::walls::{DamperWall, DelayedSpring, OneSided};

impl<const KNOTS: usize, const N: usize> FreeModeProfile<Profile<KNOTS, N>> {
    /// As data.
    pub const fn as_data(&self) -> Environment {
        let (residual, profile) = (Some(self.residual), self.profile.as_any());
        Environment::Composed(Composed { residual, wall: None, profile })
    }
}

macro_rules! beside_walls {
    ($($wall:ty),*) => {$(
        impl<const KNOTS: usize, const D: usize, const N: usize>
            WallAndProfile<$wall, Profile<KNOTS, N>>
        {
            /// As data.
            pub const fn as_data(&self) -> Environment {
                let (wall, profile) = (Some(self.wall.as_wall()), self.profile.as_any());
                Environment::Composed(Composed { residual: None, wall, profile })
            }
        }

        impl<const KNOTS: usize, const D: usize, const N: usize>
            FreeModeWallAndProfile<$wall, Profile<KNOTS, N>>
        {
            /// As data.
            pub const fn as_data(&self) -> Environment {
                let (wall, profile) = (Some(self.wall.as_wall()), self.profile.as_any());
                Environment::Composed(Composed { residual: Some(self.residual), wall, profile })
            }
        }
    )*};
}

beside_walls!(DelayedSpring<D>, DamperWall<D>, OneSided<DelayedSpring<D>>, OneSided<DamperWall<D>>);
