//! A mode's table: the knots of a torque profile without cells.

use super::knots::Outline;
use super::layout::Layout;
use super::shape::Shape;
use super::shape_error::ShapeError;
use super::sum::sampled;

/// The table of one of several torque profiles: its knots, two bytes each, in flash. [`Knots`](super::Knots)
/// also have the cells between the knots, ten bytes per knot, which make a tick a few instructions shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeTable<const KNOTS: usize> {
    units: [i16; KNOTS],
    outline: Outline,
    layout: Layout,
}

/// A torque profile with a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileMode {
    /// In bytes, which a constant can compare.
    name: &'static [u8],
    /// Its table, not delayed.
    pub(super) units: &'static [i16],
    pub(super) outline: Outline,
    pub(super) layout: Layout,
}

impl ProfileMode {
    /// Its name.
    pub const fn name(&self) -> &'static str {
        match core::str::from_utf8(self.name) {
            Ok(name) => name,
            Err(_) => "",
        }
    }
}

impl<const KNOTS: usize> ModeTable<KNOTS> {
    /// The sum of shapes; without shapes, the profile of a freely turning knob.
    ///
    /// # Errors
    /// If the shapes do not make a profile.
    pub const fn sampled(shapes: &[Shape]) -> Result<Self, ShapeError> {
        const { assert!(KNOTS.is_power_of_two() && KNOTS >= 8, "a power of two from 8 on") };
        let mut units = [0; KNOTS];
        // All units are zero for any torque.
        let mut found =
            (Layout { torque: 1.0, count: 1.0, centre: 0.0, ends: None, snap: None }, true);
        if !shapes.is_empty() {
            found = ok!(sampled(shapes, &mut units));
        }
        let (layout, wraps) = found;
        Ok(Self { units, outline: Outline::of(&units, wraps), layout })
    }

    /// For constants: the same, or a compile error with the reason.
    ///
    /// # Panics
    /// If the shapes do not make a profile; in a constant this is a compile error.
    #[track_caller]
    pub const fn of(shapes: &[Shape]) -> Self {
        match Self::sampled(shapes) {
            Ok(table) => table,
            Err(error) => error.refuse(),
        }
    }

    /// The table as a mode of this name.
    pub const fn named(&'static self, name: &'static str) -> ProfileMode {
        ProfileMode {
            name: name.as_bytes(),
            units: &self.units,
            outline: self.outline,
            layout: self.layout,
        }
    }
}
