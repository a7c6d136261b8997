//! Environments as sums of parts, all at the same position `x_E`: a canceller of the device's damping, a wall,
//! a torque profile and a drag, each of them at most once.
//!
//! Their passivity indices add, with a torque limit on the sum as well (theory, section 14.3). In a sum the
//! profile is late by at least one sample, because an undelayed profile is solved in front of the coupling,
//! and the canceller is not late. A wall is at one angle of many turns, so the profile beside it must have end
//! stops.
//!
//! If parts have parameters of the same name, `stiffness`, `damping` and `face` are the wall's; `torque`,
//! `count`, `centre`, `from`, `to` and `delay` the profile's; `residual` the canceller's; `drag` the drag's.
//! Without a wall, `stiffness` is that of the end stops.

use core::fmt::Debug;

use super::anticogging::Anticogging;
use super::canceller::Canceller;
use super::drag::Drag;
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
    /// A damper that acts everywhere.
    pub drag: Option<Drag>,
    /// Opposes the cogging of the motor, outside of the coupling. It is no part of the sum.
    pub anticogging: Option<Anticogging>,
}

/// Gives a macro all parts, in the order in which their torques are added: a type parameter for the law, the
/// name and the data of each. The first of them has the delay of the sum.
macro_rules! for_each_part {
    ($macro:ident) => {
        $macro! {
            P profile: super::profile::Profile,
            W wall: super::wall::Wall,
            D drag: super::drag::Drag,
            C canceller: super::canceller::Canceller,
        }
    };
}
pub(super) use for_each_part;

macro_rules! parts {
    ($($law:ident $part:ident: $data:ty,)+) => {
        impl Parts {
            /// No part: no torque.
            pub const NONE: Self = Self { $($part: None,)+ anticogging: None };

            /// The number of parts.
            pub const fn count(&self) -> usize {
                0 $(+ self.$part.is_some() as usize)+
            }

            /// Whether a part is late by at least one sample, and no part is not.
            pub const fn is_late(&self) -> bool {
                $(if let Some(part) = &self.$part && part.delay == 0 {
                    return false;
                })+
                self.count() > 0
            }

            /// The delay in whole samples: that of the first part.
            pub(super) const fn delay(&self) -> usize {
                $(if let Some(part) = &self.$part {
                    return part.delay;
                })+
                0
            }

            /// The longest delay of a part in whole samples.
            pub(crate) const fn longest_delay(&self) -> usize {
                let mut longest = 0;
                $(if let Some(part) = &self.$part && part.delay > longest {
                    longest = part.delay;
                })+
                longest
            }

            /// [`Parts::delay`], mutable; `None` without parts.
            pub(super) const fn delay_mut(&mut self) -> Option<&mut usize> {
                $(if let Some(part) = &mut self.$part {
                    return Some(&mut part.delay);
                })+
                None
            }

            /// The parts by their names.
            pub fn named(&self) -> impl Iterator<Item = (&'static str, &dyn Debug)> {
                let all = [$(
                    (stringify!($part), self.$part.as_ref().map(|part| part as &dyn Debug))
                ),+];
                all.into_iter().rev().filter_map(|(name, part)| Some((name, part?)))
            }
        }

        /// Which parts a type of environment may have. Its program omits the certificate's code for some of the
        /// others, and rejects a scene that has them.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct PartSet {$(
            #[doc = concat!("Whether it may have a ", stringify!($part), ".")]
            pub $part: bool,
        )+
            /// Whether it may oppose the cogging of the motor.
            pub anticogging: bool,
        }

        impl PartSet {
            /// None.
            pub const NONE: Self = Self::of(&Parts::NONE);
            /// All.
            pub const ALL: Self = Self { $($part: true,)+ anticogging: true };

            /// Whether there may be another part than a wall and a torque profile, whose torque is a line at all
            /// positions.
            pub(crate) const fn has_lines(self) -> bool {
                (0 $(+ self.$part as usize)+) > self.wall as usize + self.profile as usize
            }

            /// Those of a program's environment.
            pub(crate) const fn of(parts: &Parts) -> Self {
                Self { $($part: parts.$part.is_some(),)+ anticogging: parts.anticogging.is_some() }
            }
        }
    };
}
for_each_part!(parts);

impl Parts {
    /// Makes the wall, and the parts that are as late as it, late by this many samples.
    pub const fn set_wall_delay(&mut self, delay: usize) {
        if let Some(wall) = &mut self.wall {
            wall.delay = delay;
        }
        if let Some(canceller) = &mut self.canceller {
            canceller.delay = delay;
        }
        self.align_drag();
    }

    /// Makes a drag as late as the first of the other parts: a scene file has one delay for both.
    pub(super) const fn align_drag(&mut self) {
        let delay = self.delay();
        if let Some(drag) = &mut self.drag {
            drag.delay = delay;
        }
    }

    /// The same with a drag of this damping in N m s/rad, as late as the others. A canceller is then not
    /// late.
    pub(super) const fn with_drag(self, damping: f64) -> Self {
        let mut parts = self;
        parts.drag = Some(Drag::of(damping, self.delay()));
        if let Some(canceller) = &mut parts.canceller {
            canceller.delay = 0;
        }
        parts
    }

    /// Largest torque in N m that opposes cogging.
    pub const fn against_cogging(&self) -> f64 {
        match &self.anticogging {
            Some(anticogging) => anticogging.largest(),
            None => 0.0,
        }
    }

    /// The anticogging, and its delay in whole samples: one where all parts are late, because the torque of such an
    /// environment may be latched.
    pub const fn late_anticogging(&self) -> Option<(Anticogging, usize)> {
        let anticogging = some!(self.anticogging);
        Some((anticogging, self.is_late() as usize))
    }

    /// The number of parts besides a canceller, a wall and a torque profile: proofs about these that do not
    /// add part by part do not cover others.
    pub const fn others(&self) -> usize {
        let Self { canceller, wall, profile, .. } = self;
        let known = canceller.is_some() as usize + wall.is_some() as usize;
        self.count() - known - profile.is_some() as usize
    }

    /// Damping in N m s/rad of the dampers that act everywhere, whether a wall is in contact or not.
    pub fn damping_everywhere(&self) -> f64 {
        let drag = self.drag.map_or(0.0, |drag| drag.damping);
        drag + self.profile.as_ref().map_or(0.0, Profile::damping)
    }

    /// Whether a part is not linear even without a torque limit, apart from a torque profile.
    pub(crate) const fn is_switched(&self) -> bool {
        matches!(&self.wall, Some(wall) if wall.is_one_sided())
    }

    /// Whether the torque depends on a velocity.
    pub const fn is_damped(&self) -> bool {
        let Self { canceller, wall, profile, drag, .. } = self;
        canceller.is_some()
            || matches!(wall, Some(wall) if wall.damping() != 0.0)
            || matches!(profile, Some(profile) if profile.damping() != 0.0)
            || matches!(drag, Some(drag) if drag.damping != 0.0)
    }
}
