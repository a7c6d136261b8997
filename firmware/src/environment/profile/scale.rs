//! The coefficients of a law before a number format rounds them: the certificate judges the rounded values.

use super::knots::{FULL_SCALE, Outline};
use super::layout::{Layout, PART_BITS};

/// Scales of a profile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Parts of a cell per rad.
    pub parts_per_rad: f64,
    /// Torque in N m of a part of a unit.
    pub torque_of_part: f64,
}

impl Scale {
    /// Of a table.
    pub(crate) const fn of(layout: &Layout, outline: &Outline) -> Self {
        const PARTS: f64 = (1_u32 << PART_BITS) as f64;
        let parts_per_rad = layout.knots_per_rad(outline.knots) * PARTS;
        Self { parts_per_rad, torque_of_part: layout.torque / (FULL_SCALE as f64 * PARTS) }
    }

    /// The steepest rise in N m/rad of a table.
    pub(crate) const fn steepest_rise(&self, outline: &Outline) -> f64 {
        outline.rise as f64 * self.torque_of_part * self.parts_per_rad
    }
}
