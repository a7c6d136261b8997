//! The layout of a table of knots: its position, scale and ends, and the detents with a snap point that are
//! added to it.

use core::f64::consts::TAU;

/// Parts of a cell, as a power of two: the unit of places in a table.
pub(super) const PART_BITS: u32 = 14;

/// The ends of a range, and the springs beyond them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Ends {
    /// Lower end in rad.
    pub from: f64,
    /// Upper end in rad.
    pub to: f64,
    /// Stiffness in N m/rad beyond them.
    pub stiffness: f64,
}

/// The position and the scale of a table of knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Torque in N m of a knot at full scale.
    pub torque: f64,
    /// Repetitions of the table in a turn.
    pub count: f64,
    /// Angle in rad of the first knot.
    pub centre: f64,
    /// The ends of its range; `None`: it repeats without end.
    pub ends: Option<Ends>,
    /// Detents with a snap point that are added to it.
    pub snap: Option<SnapPoint>,
}

impl Layout {
    /// Knots per rad of a table of this many knots, as in its law.
    pub const fn knots_per_rad(&self, knots: u32) -> f64 {
        self.count * knots as f64 / TAU
    }
}

/// Detents with a snap point, in proportion to the table that they are added to, so that they change with
/// its torque, its number of repetitions, and its centre. Only [shapes](super::Shape::snap) give one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct SnapPoint {
    /// Detents in a repetition of the table.
    pitches: f64,
    /// Centre of the first detent in pitches from the first knot, with a magnitude up to one half.
    pub(super) offset: f64,
    /// Torque at the snap point relative to the torque of the table.
    share: f64,
    /// Pitches from the centre to the snap point.
    pub(super) snap: f64,
}

/// Tolerance in pitches for a detent's centre beyond an end, because ends are written with few digits.
const AT_THE_END: f64 = 0.01;

impl SnapPoint {
    /// The snap point of `count` detents per turn of `torque` N m, the first at the angle `centre` in rad,
    /// added to a table with this layout.
    pub(super) const fn new(
        layout: &Layout,
        count: u32,
        torque: f64,
        centre: f64,
        snap: f64,
    ) -> Self {
        let offset = (centre - layout.centre) * count as f64 / TAU;
        let offset = offset - nearest(offset);
        Self { pitches: count as f64 / layout.count, offset, share: torque / layout.torque, snap }
    }

    /// Distance in rad between two detents.
    pub const fn pitch(&self, layout: &Layout) -> f64 {
        TAU / (layout.count * self.pitches)
    }

    /// Centre in rad of a detent.
    pub const fn centre(&self, layout: &Layout, branch: i32) -> f64 {
        layout.centre + (self.offset + branch as f64) * self.pitch(layout)
    }

    /// Pitches from a centre to the snap point.
    pub const fn snap(&self) -> f64 {
        self.snap
    }

    /// Torque in N m at the snap point.
    pub const fn torque(&self, layout: &Layout) -> f64 {
        layout.torque * self.share
    }

    /// Angle in rad from a snap point back to the point where the knob would snap back.
    pub const fn hysteresis(&self, layout: &Layout) -> f64 {
        (2.0 * self.snap - 1.0) * self.pitch(layout)
    }

    /// The detents that can hold the knob: those with their centre between the ends; without ends, all. If no
    /// detent can, the first is above the last.
    pub const fn branches(&self, layout: &Layout) -> (i32, i32) {
        let Some(Ends { from, to, .. }) = layout.ends else { return (i32::MIN, i32::MAX) };
        let (pitch, first) = (self.pitch(layout), self.centre(layout, 0));
        let lowest = -down(AT_THE_END - (from - first) / pitch);
        let highest = down(AT_THE_END + (to - first) / pitch);
        (lowest as i32, highest as i32)
    }

    /// Whether the detents are symmetric about the first knot of the table.
    pub(crate) const fn is_centred(&self) -> bool {
        self.offset == 0.0 || self.offset.abs() == 0.5
    }

    /// Parts of a cell from one detent to the next, for a table of this many knots.
    pub(super) const fn parts(&self, knots: u32) -> f64 {
        knots as f64 * (1_u32 << PART_BITS) as f64 / self.pitches
    }

    /// Torque in N m for a part of a cell: the slope of all branches.
    pub(crate) const fn torque_of_part(&self, torque: f64, knots: u32) -> f64 {
        torque * self.share / (self.snap * self.parts(knots))
    }
}

/// The largest whole number that is not above `x`, for magnitudes below 2^62.
pub(super) const fn down(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

/// The nearest whole number.
pub(super) const fn nearest(x: f64) -> f64 {
    down(x + 0.5)
}
