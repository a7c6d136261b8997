//! A torque profile's knots: a table of equal cells in flash, and its outline for the certificate.

use super::layout::{Layout, PART_BITS};

/// The largest unit of a knot: it stands for the profile's torque. The step from one knot to the next
/// fits 16 bits, too.
pub const FULL_SCALE: i16 = (1 << 14) - 1;

/// The most knots that a table may have in a turn, all of its repetitions together, so that places in it fit
/// 32 bits. A narrower cell is out of range.
pub const MOST_KNOTS: u32 = 1 << 16;

/// Knots of a torque profile in parts of its torque, with [`FULL_SCALE`] for the whole torque, over cells of
/// equal width. After the last knot the first follows again.
///
/// Whole numbers, so that the sum over a period is exact in every number format. `KNOTS` is a power of two,
/// so that a tick finds its cell by masking bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knots<const KNOTS: usize> {
    units: [i16; KNOTS],
    cells: [Cell; KNOTS],
    outline: Outline,
    layout: Layout,
}

/// The properties of a table of knots for the certificate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Outline {
    /// Number of knots.
    pub knots: u32,
    /// The largest rise from one knot to the next; not negative.
    pub rise: i32,
    /// The largest fall from one knot to the next; not negative.
    pub fall: i32,
    /// Whether the cell from the last knot to the first is used. If not, the profile has ends that exclude
    /// this cell, and its step does not count.
    pub wraps: bool,
    /// Sum of all knots: must be zero for a profile without ends, which would otherwise be a motor.
    pub sum: i32,
    /// Whether the profile is odd about its first knot, so that its mean stays zero when a limit clips its
    /// torque at any level.
    pub is_odd: bool,
}

impl<const KNOTS: usize> Knots<KNOTS> {
    pub(super) const fn new(units: [i16; KNOTS], wraps: bool, layout: Layout) -> Self {
        const { assert!(KNOTS.is_power_of_two() && KNOTS >= 8, "a power of two from 8 on") };
        let mut cells = [Cell::between(0, 0); KNOTS];
        each!(i in 0..KNOTS => {
            cells[i] = Cell::between(units[i], units[(i + 1) % KNOTS]);
        });
        Self { units, cells, outline: Outline::of(&units, wraps), layout }
    }

    /// The cells from each knot to the next.
    pub(super) const fn cells(&self) -> &[Cell; KNOTS] {
        &self.cells
    }

    /// Their position and scale.
    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// The units.
    pub const fn units(&self) -> &[i16; KNOTS] {
        &self.units
    }

    /// Their outline for the certificate.
    pub const fn outline(&self) -> Outline {
        self.outline
    }
}

impl Outline {
    /// The outline of knots; `wraps`: whether the step from the last knot to the first is used.
    pub const fn of(units: &[i16], wraps: bool) -> Self {
        let mut out =
            Self { knots: units.len() as u32, rise: 0, fall: 0, wraps, sum: 0, is_odd: true };
        each!(i in 0..units.len() => {
            let (here, mirrored) = (units[i] as i32, units[(units.len() - i) % units.len()] as i32);
            out.sum += here;
            out.is_odd &= here == -mirrored;
            if i + 1 < units.len() || wraps {
                let step = units[(i + 1) % units.len()] as i32 - here;
                out.rise = if step > out.rise { step } else { out.rise };
                out.fall = if -step > out.fall { -step } else { out.fall };
            }
        });
        out
    }
}

/// The straight line from one knot to the next; a tick reads both of its numbers at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Units at its beginning, in parts.
    from: i32,
    /// Units from there to its end.
    rise: i32,
}

impl Cell {
    const fn between(from: i16, to: i16) -> Self {
        let (from, to) = (from as i32, to as i32);
        Self { from: from << PART_BITS, rise: to - from }
    }

    /// Units at a place in the cell, both in parts.
    #[inline(always)]
    const fn at(self, place: i32) -> i32 {
        let part = place & ((1 << PART_BITS) - 1);
        // At most 2^28 and 2^29: no overflow.
        self.from.wrapping_add(self.rise.wrapping_mul(part))
    }
}

/// The table of a torque profile.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Table {
    #[cfg_attr(feature = "wire", serde(skip))]
    units: &'static [i16],
    /// The same in cells, which make a tick shorter; empty: none.
    #[cfg_attr(feature = "wire", serde(skip))]
    cells: &'static [Cell],
    outline: Outline,
}

impl Table {
    pub(super) const fn new(
        units: &'static [i16],
        cells: &'static [Cell],
        outline: Outline,
    ) -> Self {
        Self { units, cells, outline }
    }

    pub(super) const fn units(&self) -> &'static [i16] {
        self.units
    }

    pub(super) const fn cells(&self) -> &'static [Cell] {
        self.cells
    }

    pub(super) const fn outline(&self) -> Outline {
        self.outline
    }
}

/// A table that a law can read.
pub trait KnotTable: Copy + core::fmt::Debug + Sized {
    /// That of a profile; `None` if it is stored in another form.
    fn of(table: &Table) -> Option<Self>;
    /// Units in parts at a place, in parts of a cell from the first knot; every number is a valid place.
    fn units_at(self, place: i32) -> i32;
}

impl<const KNOTS: usize> KnotTable for &'static [Cell; KNOTS] {
    fn of(table: &Table) -> Option<Self> {
        table.cells.try_into().ok()
    }

    #[inline(always)]
    fn units_at(self, place: i32) -> i32 {
        let cell = (place >> PART_BITS).cast_unsigned() as usize;
        // Masked by the length less one, a power of two, so the compiler omits the bounds check.
        self[cell & (KNOTS - 1)].at(place)
    }
}

/// The knots of a profile as data.
impl KnotTable for &'static [i16] {
    fn of(table: &Table) -> Option<Self> {
        let units = table.units;
        let is_whole = units.len() == table.outline.knots as usize;
        (is_whole && units.len().is_power_of_two()).then_some(units)
    }

    #[inline(always)]
    fn units_at(self, place: i32) -> i32 {
        let mask = self.len().wrapping_sub(1);
        let from = (place >> PART_BITS).cast_unsigned() as usize;
        let knot = |i: usize| self.get(i & mask).copied().unwrap_or(0);
        Cell::between(knot(from), knot(from.wrapping_add(1))).at(place)
    }
}
