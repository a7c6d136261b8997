//! A torque profile's knots: a table of equal cells that stays in flash, and all that the certificate
//! asks of it.

use super::sum::Layout;
pub use crate::number::KNOT_FULL_SCALE as FULL_SCALE;

/// Knots of a torque profile in parts of its torque, [`FULL_SCALE`] for all of it, over cells of equal
/// width. After the last knot comes the first one again.
///
/// Whole numbers, so that the sum over a period is exact in every number format. `KNOTS` is a power of two,
/// so that a tick finds its cell by leaving bits out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knots<const KNOTS: usize> {
    units: [i16; KNOTS],
    outline: Outline,
    layout: Layout,
}

/// What the certificate asks of a table of knots.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Outline {
    /// Number of knots.
    pub knots: u32,
    /// The most by which one knot is above the one before it; not negative.
    pub rise: i32,
    /// The most by which one knot is below the one before it; not negative.
    pub fall: i32,
    /// Whether the cell from the last knot to the first is one like the others. If not, the profile has
    /// ends that keep out of it, and its steps count for nothing.
    pub wraps: bool,
    /// Sum of all knots: zero, or a profile without ends is a motor.
    pub sum: i32,
    /// Whether the profile is odd about its first knot, so that its mean stays zero where a limit clips
    /// its torque at any level.
    pub is_odd: bool,
}

impl<const KNOTS: usize> Knots<KNOTS> {
    pub(super) const fn new(units: [i16; KNOTS], wraps: bool, layout: Layout) -> Self {
        const { assert!(KNOTS.is_power_of_two() && KNOTS >= 8, "a power of two from 8 on") };
        Self { units, outline: Outline::of(&units, wraps), layout }
    }

    /// Where they are.
    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// The units.
    pub const fn units(&self) -> &[i16; KNOTS] {
        &self.units
    }

    /// What the certificate asks of them.
    pub const fn outline(&self) -> Outline {
        self.outline
    }
}

impl Outline {
    /// Of knots; `wraps` says whether the step from the last one to the first is felt.
    pub const fn of(units: &[i16], wraps: bool) -> Self {
        let mut out =
            Self { knots: units.len() as u32, rise: 0, fall: 0, wraps, sum: 0, is_odd: true };
        let mut i = 0;
        while i < units.len() {
            let (here, mirrored) = (units[i] as i32, units[(units.len() - i) % units.len()] as i32);
            out.sum += here;
            out.is_odd &= here == -mirrored;
            if i + 1 < units.len() || wraps {
                let step = units[(i + 1) % units.len()] as i32 - here;
                out.rise = if step > out.rise { step } else { out.rise };
                out.fall = if -step > out.fall { -step } else { out.fall };
            }
            i += 1;
        }
        out
    }
}

/// Where a law reads the two knots of a cell.
pub trait KnotTable: Copy + core::fmt::Debug {
    /// Knots at the beginning and at the end of a cell; any number is that of a cell.
    fn around(self, cell: i32) -> (i32, i32);
}

impl<const KNOTS: usize> KnotTable for &'static [i16; KNOTS] {
    #[inline(always)]
    fn around(self, cell: i32) -> (i32, i32) {
        let from = cell.cast_unsigned() as usize;
        let (from, to) = (from & (KNOTS - 1), from.wrapping_add(1) & (KNOTS - 1));
        // Masked by the length less one, a power of two: the compiler sees that both are there.
        (i32::from(self[from]), i32::from(self[to]))
    }
}

/// The knots of a profile that is data.
impl KnotTable for &'static [i16] {
    #[inline(always)]
    fn around(self, cell: i32) -> (i32, i32) {
        let mask = self.len().wrapping_sub(1);
        let from = cell.cast_unsigned() as usize;
        let knot = |i: usize| self.get(i & mask).copied().map_or(0, i32::from);
        (knot(from), knot(from.wrapping_add(1)))
    }
}
