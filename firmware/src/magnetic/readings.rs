//! The readings of a chip, tick by tick: the angle, or for some failed transfers the angle before.

use core::hint::cold_path;

use super::{Chip, Frame, ReadingError};

/// The last angle, and what has come since.
#[derive(Clone, Debug)]
pub struct Readings {
    /// The last angle in counts, with [`FAILED`], [`EQUAL`] or [`NONE`].
    count: u32,
    /// Failed transfers in a row, if the angle says that one has failed: so a good one has nothing to reset.
    failed: u16,
    /// Equal angles in a row, if the angle says that the last one was as that before, for the same reason.
    equal: u16,
}

/// Beside the last angle: the last transfer has failed. No chip has as many bits.
const FAILED: u32 = 1 << 31;
/// Beside it: it was as the one before.
const EQUAL: u32 = 1 << 30;
/// In its place: there was none yet. In a turn of any chip that is zero.
const NONE: u32 = 1 << 29;

/// The part of a turn to either side of zero in which words of ones are angles.
const NEAR: u32 = 256;

impl Readings {
    /// No reading yet.
    pub const fn none() -> Self {
        Self { count: NONE, failed: 0, equal: 0 }
    }

    /// Takes a transfer, of which so many in a row may fail, as the scene's certificate says; whether it has an angle.
    /// A failed one is replaced by the angle before. `has_fallen` is asked after a word of zeros: whether the data line
    /// has fallen in its transfer.
    ///
    /// # Errors
    /// If more transfers in a row have failed than are allowed, or if the chip has stopped.
    #[inline(always)]
    pub fn take(
        &mut self,
        chip: &Chip,
        frame: &Frame,
        allowed: u16,
        has_fallen: impl FnOnce() -> bool,
    ) -> Result<bool, ReadingError> {
        // A word of zeros is an angle, and a handle may rest there. No checksum tells it from a wire at ground, but the
        // line does: it is pulled up, high while the chip is not selected, and falls for such a word. A line that
        // nothing drives is as high as a word of ones. So these are an angle only beside zero, and until the chip
        // counts as frozen.
        let count = match (chip.decode)(frame) {
            Ok(count) => count,
            Err(ReadingError::Zeros) if has_fallen() => {
                cold_path();
                0
            }
            Err(error) => {
                cold_path();
                let has_angle = chip.ones_are_angle && self.count & NONE == 0;
                if error != ReadingError::Ones || !has_angle || !self.is_near_zero(chip) {
                    return self.fail(error, allowed);
                }
                chip.width.mask()
            }
        };
        let mut told = count;
        if let Some(most) = chip.frozen_after
            && (count ^ self.count) & !(FAILED | EQUAL) == 0
        {
            cold_path();
            self.equal = if self.count & EQUAL == 0 { 1 } else { self.equal.saturating_add(1) };
            if self.equal >= most {
                return Err(ReadingError::Frozen);
            }
            told |= EQUAL;
        }
        self.count = told;
        Ok(true)
    }

    /// The same for a transfer without an angle.
    ///
    /// # Errors
    /// If more transfers in a row have failed than are allowed.
    #[cold]
    #[inline(never)]
    pub fn fail(&mut self, error: ReadingError, allowed: u16) -> Result<bool, ReadingError> {
        let before = if self.count & FAILED == 0 { 0 } else { self.failed };
        self.failed = before.saturating_add(1);
        self.count |= FAILED;
        if self.failed > allowed { Err(error) } else { Ok(false) }
    }

    /// Whether the last angle is beside zero, or if there was none yet.
    #[inline(always)]
    const fn is_near_zero(&self, chip: &Chip) -> bool {
        let turn = chip.width.mask();
        // One bit test: of both sides, as many counts as a power of two.
        let near = turn / NEAR;
        self.count.wrapping_add(near) & (turn & !(2 * near + 1)) == 0
    }

    /// The last angle in counts, in a turn of the chip; there zero if there was none yet.
    #[inline(always)]
    pub const fn count(&self) -> u32 {
        self.count
    }
}
