//! A torque profile as data.

use super::knots::{Knots, Outline};
use super::law::ProfileLaw;
use super::layout::{Ends, Layout, SnapPoint};
use super::mode_table::ProfileMode;
use super::scale::Scale;
use super::selection::ModeSelection;
use super::shape::Shape;
use super::shape_error::ShapeError;
use super::snap::{AnySnap, NoSnap, Snap};
use super::sum::sampled;
use super::{DampedProfile, Profile, SnapProfile};
use crate::build_error::BuildError;
use crate::environment::delay_line::VariableDelay;
use crate::environment::law::{Discretize, LawContext};
use crate::environment::velocity::{AnyVelocity, Difference, NoDamping};
use crate::number::Number;

/// Any torque profile as data.
///
/// The wire does not carry its table, only the outline that the certificate needs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct AnyProfile {
    #[cfg_attr(feature = "wire", serde(skip))]
    units: &'static [i16],
    outline: Outline,
    /// Torque in N m of a knot at full scale.
    pub torque: f64,
    /// Repetitions of the table in a turn.
    pub count: f64,
    /// Angle in rad of its first knot.
    pub centre: f64,
    /// The ends of its range; `None`: it repeats without end.
    pub ends: Option<Ends>,
    /// Damping `B` in N m s/rad in addition.
    pub damping: f64,
    /// Delay in whole samples.
    pub delay: usize,
    /// Detents with a snap point in addition.
    pub snap: Option<SnapPoint>,
    /// The modes among which it is selected; `None`: it is the only profile.
    pub modes: Option<ModeSelection>,
}

impl AnyProfile {
    /// The sum of shapes, sampled into the table `units`, which lives as long as the program. The number of
    /// its knots must be a power of two from 8 on.
    ///
    /// # Errors
    /// If the shapes do not make a profile.
    pub fn sampled(
        shapes: &[Shape],
        units: &'static mut [i16],
        delay: usize,
    ) -> Result<Self, ShapeError> {
        let (layout, wraps) = sampled(shapes, units)?;
        let outline = Outline::of(units, wraps);
        Ok(Self::of(units, outline, layout, 0.0, delay))
    }

    pub(super) const fn of(
        units: &'static [i16],
        outline: Outline,
        layout: Layout,
        damping: f64,
        delay: usize,
    ) -> Self {
        let Layout { torque, count, centre, ends, snap } = layout;
        Self { units, outline, torque, count, centre, ends, damping, delay, snap, modes: None }
    }

    /// One of several modes, late by `delay` samples.
    pub(super) const fn of_mode(mode: &ProfileMode, modes: ModeSelection, delay: usize) -> Self {
        let profile = Self::of(mode.units, mode.outline, mode.layout, 0.0, delay);
        Self { modes: Some(modes), ..profile }
    }

    /// The selected mode, late by `delay` samples; `None` if there is no such mode, or if it came over the
    /// wire.
    pub(super) const fn selected(modes: ModeSelection, delay: usize) -> Option<Self> {
        match modes.selected() {
            Some(mode) => Some(Self::of_mode(mode, modes, delay)),
            None => None,
        }
    }

    /// The same with another mode selected; `None` if there is no such mode, or if it came over the wire,
    /// without the tables of the other modes.
    pub const fn selecting(&self, mode: f64) -> Option<Self> {
        match &self.modes {
            Some(modes) => Self::selected(modes.selecting(mode), self.delay),
            None => None,
        }
    }

    /// The law of its snap points, with the place of the first knot.
    pub(super) fn snap_law<N: Number>(&self, origin: i32) -> Result<AnySnap<N>, BuildError> {
        Ok(match &self.snap {
            None => AnySnap::None(NoSnap),
            Some(snap) => {
                AnySnap::Snap(Snap::new(snap, &self.layout(), self.outline.knots, origin)?)
            }
        })
    }

    /// The numbers by which its law multiplies.
    pub(crate) const fn scale(&self) -> Scale {
        Scale::of(&self.layout(), &self.outline)
    }

    /// The outline of its table for the certificate.
    pub const fn outline(&self) -> Outline {
        self.outline
    }

    /// Knots in a rad.
    pub const fn knots_per_rad(&self) -> f64 {
        self.layout().knots_per_rad(self.outline.knots)
    }

    /// The position and the scale of its table.
    pub const fn layout(&self) -> Layout {
        let Self { torque, count, centre, ends, snap, .. } = *self;
        Layout { torque, count, centre, ends, snap }
    }

    /// The knots in parts of its torque, with [`FULL_SCALE`](super::FULL_SCALE) for the whole torque; empty
    /// if it came over the wire.
    pub const fn units(&self) -> &'static [i16] {
        self.units
    }
}

impl<const KNOTS: usize, const DELAY: usize> Profile<KNOTS, DELAY> {
    /// The profile as such data.
    pub const fn as_any(&self) -> AnyProfile {
        let knots: &'static Knots<KNOTS> = self.knots;
        AnyProfile::of(knots.units(), knots.outline(), self.layout(), 0.0, DELAY)
    }
}

impl<const KNOTS: usize, const DELAY: usize> DampedProfile<KNOTS, DELAY> {
    /// The profile as such data.
    pub const fn as_any(&self) -> AnyProfile {
        AnyProfile { damping: self.damping, ..self.profile.as_any() }
    }
}

impl<const KNOTS: usize, const DELAY: usize> SnapProfile<KNOTS, DELAY> {
    /// The profile as such data.
    pub const fn as_any(&self) -> AnyProfile {
        AnyProfile { snap: Some(self.snap), ..self.profile.as_any() }
    }
}

impl<N: Number> Discretize<N> for AnyProfile {
    type Law = ProfileLaw<N, &'static [i16], AnyVelocity<N>, VariableDelay<N>, AnySnap<N>>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        if self.units.len() != self.outline.knots as usize || !self.units.len().is_power_of_two() {
            return Err(BuildError::LawElsewhere);
        }
        let velocity = if self.damping == 0.0 {
            AnyVelocity::None(NoDamping)
        } else {
            AnyVelocity::Difference(Difference::new(self.damping, context.period)?)
        };
        let delay = VariableDelay::at_rest(self.delay)?;
        let snap = |origin| self.snap_law(origin);
        ProfileLaw::new(self.units, &self.outline, &self.layout(), velocity, delay, snap)
    }
}

/// The law of any torque profile.
pub(in crate::environment) type AnyProfileLaw<N> = <AnyProfile as Discretize<N>>::Law;
