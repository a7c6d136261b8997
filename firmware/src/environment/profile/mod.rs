//! Torque profiles: torque over angle in straight lines, for detents, end stops, switches and textures.
//!
//! A profile is one table of [`Knots`], built from [`Shape`]s in a constant. It stays in flash, and a tick
//! reads two of its knots, for any shapes. A profile without ends repeats a whole number of times per turn,
//! and its law counts angles within the turn, so no error accumulates over any number of turns.
//!
//! The torque of a late profile is that of the environment's position `x_E` some samples ago. The torque of
//! an undelayed profile (`DELAY = 0`) is that of the position in front of the coupling, as the hand feels it:
//! `F = g(x)`. If `V g' < 1` this is a profile `f` of `x_E = x - V g(x)` with the slope `g' / (1 - V g')`,
//! solved in advance (theory, section 14).

mod any;
mod knots;
mod law;
mod layout;
mod mode_table;
mod modes;
mod profile_modes;
mod scale;
mod selection;
mod shape;
mod shape_error;
mod snap;
mod snap_profile;
mod sum;

pub use any::AnyProfile;
pub(super) use any::AnyProfileLaw;
pub use knots::{Cell, FULL_SCALE, KnotTable, Knots, MOST_KNOTS, Outline};
pub use law::ProfileLaw;
pub use layout::{Ends, Layout, SnapPoint};
pub use mode_table::{ModeTable, ProfileMode};
pub use modes::{KNOB_MODES, MODES, Mode};
pub use profile_modes::ProfileModes;
pub use selection::ModeSelection;
pub use shape::Shape;
pub use shape_error::ShapeError;
pub use snap::{AnySnap, Holding, NoSnap, Snap};
pub use snap_profile::SnapProfile;

use super::delay_line::FixedDelay;
use super::law::{Discretize, LawContext};
use super::velocity::{Difference, NoDamping};
use crate::build_error::BuildError;
use crate::number::Number;
use crate::parameter::{NamedParameters, Parameter};

/// A torque profile, delayed by whole samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile<const KNOTS: usize, const DELAY: usize> {
    /// The table.
    pub knots: &'static Knots<KNOTS>,
    /// Torque in N m of a knot at full scale.
    pub torque: f64,
    /// Repetitions of the table in a turn.
    pub count: f64,
    /// Angle in rad of its first knot.
    pub centre: f64,
    /// The ends of its range; `None`: it repeats without end.
    pub ends: Option<Ends>,
}

/// A [`Profile`] plus a backward-difference damper, `damping (z - 1) / (T z)`, late by the same samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedProfile<const KNOTS: usize, const DELAY: usize> {
    /// The profile.
    pub profile: Profile<KNOTS, DELAY>,
    /// Damping `B` in N m s/rad.
    pub damping: f64,
}

impl<const KNOTS: usize, const DELAY: usize> Profile<KNOTS, DELAY> {
    /// The profile of a table, with the numbers of its shapes.
    ///
    /// # Panics
    /// If a shape has a snap point, which needs a [`SnapProfile`]; in a constant this is a compile error.
    #[track_caller]
    pub const fn of(knots: &'static Knots<KNOTS>) -> Self {
        assert!(knots.layout().snap.is_none(), "detents with a snap point: use `SnapProfile::of`");
        Self::without_snap(knots)
    }

    /// The table alone.
    const fn without_snap(knots: &'static Knots<KNOTS>) -> Self {
        let Layout { torque, count, centre, ends, .. } = knots.layout();
        Self { knots, torque, count, centre, ends }
    }

    /// The profile with a damper of `damping` N m s/rad.
    pub const fn damped(self, damping: f64) -> DampedProfile<KNOTS, DELAY> {
        DampedProfile { profile: self, damping }
    }

    const fn layout(&self) -> Layout {
        let Self { torque, count, centre, ends, .. } = *self;
        Layout { torque, count, centre, ends, snap: None }
    }
}

impl<const KNOTS: usize, const DELAY: usize> NamedParameters for Profile<KNOTS, DELAY> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match (parameter, &mut self.ends) {
            (Parameter::ProfileTorque, _) => Some(&mut self.torque),
            // A profile with ends has no number of repetitions.
            (Parameter::Count, _) if self.knots.outline().wraps => Some(&mut self.count),
            (Parameter::Centre, _) if self.knots.outline().wraps => Some(&mut self.centre),
            (Parameter::From, Some(ends)) => Some(&mut ends.from),
            (Parameter::To, Some(ends)) => Some(&mut ends.to),
            (Parameter::Stiffness, Some(ends)) => Some(&mut ends.stiffness),
            _ => None,
        }
    }
}

impl<const KNOTS: usize, const DELAY: usize> NamedParameters for DampedProfile<KNOTS, DELAY> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match parameter {
            Parameter::Damping => Some(&mut self.damping),
            _ => self.profile.value(parameter),
        }
    }
}

impl<N: Number, const KNOTS: usize, const DELAY: usize> Discretize<N> for Profile<KNOTS, DELAY> {
    type Law = ProfileLaw<N, &'static [Cell; KNOTS], NoDamping, FixedDelay<N, DELAY>, NoSnap>;

    fn law(&self, _: &LawContext) -> Result<Self::Law, BuildError> {
        let (cells, outline) = (self.knots.cells(), self.knots.outline());
        let (layout, delay) = (self.layout(), FixedDelay::at_rest());
        ProfileLaw::new(cells, &outline, &layout, NoDamping, delay, |_| Ok(NoSnap))
    }
}

impl<N: Number, const KNOTS: usize, const DELAY: usize> Discretize<N>
    for DampedProfile<KNOTS, DELAY>
{
    type Law = ProfileLaw<N, &'static [Cell; KNOTS], Difference<N>, FixedDelay<N, DELAY>, NoSnap>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        let Profile { knots, .. } = self.profile;
        let velocity = Difference::new(self.damping, context.period)?;
        let (layout, delay) = (self.profile.layout(), FixedDelay::at_rest());
        let outline = knots.outline();
        ProfileLaw::new(knots.cells(), &outline, &layout, velocity, delay, |_| Ok(NoSnap))
    }
}

#[cfg(test)]
mod snap_tests;
#[cfg(test)]
mod tests;
