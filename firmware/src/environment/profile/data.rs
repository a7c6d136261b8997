//! A torque profile: its table, its place and scale.

use super::knots::{Cell, Knots, Outline, Table};
use super::layout::{Ends, Layout, SnapPoint};
use super::mode_table::ProfileMode;
use super::scale::Scale;
use super::selection::ModeSelection;
use super::shape::Shape;
use super::shape_error::ShapeError;
use super::sum::sampled;
use crate::environment::wall::Damper;
use crate::parameter::Parameter;

/// A torque profile, delayed by whole samples.
///
/// With a snap point it certifies with at most one sample of delay, behind a coupling. Of several
/// [modes](Profile::modes) each is certified, so that with the compiled numbers none is refused later;
/// another mode is swapped in like any other change
/// ([`servo_loop::longest_gap`](crate::servo_loop::longest_gap)), and each swap restarts the count of turns: a
/// mode with end stops starts in the turn in which the knob is nearest to its range.
///
/// The wire does not carry its table, only the outline that the certificate needs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Profile {
    /// The table.
    pub table: Table,
    /// Torque in N m of a knot at full scale.
    pub torque: f64,
    /// Repetitions of the table in a turn.
    pub count: f64,
    /// Angle in rad of its first knot.
    pub centre: f64,
    /// The ends of its range; `None`: it repeats without end.
    pub ends: Option<Ends>,
    /// Damping `B` in N m s/rad of a backward-difference damper in addition, late by the same samples.
    pub damping: Option<f64>,
    /// Delay in whole samples.
    pub delay: usize,
    /// Detents with a snap point in addition.
    pub snap: Option<SnapPoint>,
    /// The modes among which it is selected; `None`: it is the only profile.
    pub modes: Option<ModeSelection>,
}

impl Profile {
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
        Ok(Self::of_table(units, &[], outline, layout, delay))
    }

    /// The profile of a table, with the numbers of its shapes, late by `delay` samples.
    pub const fn of<const KNOTS: usize>(knots: &'static Knots<KNOTS>, delay: usize) -> Self {
        Self::of_table(knots.units(), knots.cells(), knots.outline(), knots.layout(), delay)
    }

    /// One of these modes, late by `delay` samples, with the first selected.
    ///
    /// # Panics
    /// If there is none; in a constant this is a compile error.
    #[track_caller]
    pub const fn of_modes(modes: &'static [ProfileMode], delay: usize) -> Self {
        assert!(!modes.is_empty(), "there is no mode to select");
        Self::of_mode(&modes[0], ModeSelection::of(modes, 0.0), delay)
    }

    pub(in crate::environment) const fn of_table(
        units: &'static [i16],
        cells: &'static [Cell],
        outline: Outline,
        layout: Layout,
        delay: usize,
    ) -> Self {
        let Layout { torque, count, centre, ends, snap } = layout;
        let (table, damping, modes) = (Table::new(units, cells, outline), None, None);
        Self { table, torque, count, centre, ends, damping, delay, snap, modes }
    }

    /// The same with a damper of `damping` N m s/rad.
    pub const fn damped(self, damping: f64) -> Self {
        Self { damping: Some(damping), ..self }
    }

    /// One of several modes, late by `delay` samples.
    pub(super) const fn of_mode(mode: &ProfileMode, modes: ModeSelection, delay: usize) -> Self {
        let profile = Self::of_table(mode.units, &[], mode.outline, mode.layout, delay);
        Self { modes: Some(modes), ..profile }
    }

    /// The selected mode, late by `delay` samples; `None` if there is no such mode, or if it came over the
    /// wire.
    pub(super) const fn selected(modes: ModeSelection, delay: usize) -> Option<Self> {
        let mode = some!(modes.selected());
        Some(Self::of_mode(mode, modes, delay))
    }

    /// The same with another mode selected; `None` if there is no such mode, or if it came over the wire,
    /// without the tables of the other modes.
    pub const fn selecting(&self, mode: f64) -> Option<Self> {
        let modes = some!(&self.modes);
        Self::selected(modes.selecting(mode), self.delay)
    }

    /// The same structure with the numbers that it has. Of several modes, the table of the selected one; the
    /// certificate refuses a number without a table.
    #[inline(always)]
    pub(crate) fn with_numbers(&self, number: impl Fn(Parameter) -> Option<f64>) -> Self {
        let of = |parameter, like| number(parameter).unwrap_or(like);
        if let Some(modes) = self.modes {
            let modes = modes.selecting(of(Parameter::Mode, modes.mode));
            return Self::selected(modes, self.delay)
                .unwrap_or(Self { modes: Some(modes), ..*self });
        }
        Self {
            torque: of(Parameter::ProfileTorque, self.torque),
            count: of(Parameter::Count, self.count),
            centre: of(Parameter::Centre, self.centre),
            ends: self.ends.map(|like| Ends {
                from: of(Parameter::From, like.from),
                to: of(Parameter::To, like.to),
                stiffness: of(Parameter::Stiffness, like.stiffness),
            }),
            damping: self.damping.map(|like| of(Parameter::Damping, like)),
            ..*self
        }
    }

    /// Damping in N m s/rad; 0 without a damper.
    pub const fn damping(&self) -> f64 {
        or!(self.damping, 0.0)
    }

    /// Its damper.
    pub(super) const fn damper(&self) -> Option<Damper> {
        let damping = some!(self.damping);
        Some(Damper { damping, filter: None })
    }

    /// The cells of its table; empty if it has none.
    pub(crate) const fn cells(&self) -> &'static [Cell] {
        self.table.cells()
    }

    /// The numbers by which its law multiplies.
    pub(crate) const fn scale(&self) -> Scale {
        Scale::of(&self.layout(), &self.table.outline())
    }

    /// The outline of its table for the certificate.
    pub const fn outline(&self) -> Outline {
        self.table.outline()
    }

    /// Knots in a rad.
    pub const fn knots_per_rad(&self) -> f64 {
        self.layout().knots_per_rad(self.table.outline().knots)
    }

    /// The position and the scale of its table.
    pub const fn layout(&self) -> Layout {
        let Self { torque, count, centre, ends, snap, .. } = *self;
        Layout { torque, count, centre, ends, snap }
    }

    /// The knots in parts of its torque, with [`FULL_SCALE`](super::FULL_SCALE) for the whole torque; empty
    /// if it came over the wire.
    pub const fn units(&self) -> &'static [i16] {
        self.table.units()
    }
}
