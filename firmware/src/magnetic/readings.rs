//! The readings of a chip, tick by tick: the angle, or for some failed transfers the angle before.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering::Relaxed};

use super::{Chip, Frame, ReadingError};

/// The last angle, and what has come since. One interrupt takes transfers; others may read the angle.
#[derive(Debug)]
pub struct Readings {
    /// The last angle in counts, or [`NONE`].
    count: AtomicU32,
    /// Failed transfers in a row.
    failed: AtomicU16,
    /// Equal angles in a row.
    equal: AtomicU16,
}

/// In place of the last angle: there was none yet. No chip has as many bits, and in a turn of any chip it is zero.
const NONE: u32 = 1 << 31;

/// The part of a turn to either side of zero in which words of equal bits are angles.
const NEAR: u32 = 256;

impl Readings {
    /// No reading yet.
    pub const fn none() -> Self {
        Self { count: AtomicU32::new(NONE), failed: AtomicU16::new(0), equal: AtomicU16::new(0) }
    }

    /// Takes a transfer, of which so many in a row may fail, as the scene's certificate says; whether it has an angle.
    /// A failed one is replaced by the angle before.
    ///
    /// # Errors
    /// If more transfers in a row have failed than are allowed, or if the chip has stopped.
    #[inline(always)]
    pub fn take(&self, chip: &Chip, frame: &Frame, allowed: u16) -> Result<bool, ReadingError> {
        let count = match (chip.decode)(frame) {
            Ok(count) => count,
            Err(error) => match self.near_zero(chip, error) {
                Some(count) => count,
                None => return self.fail(error, allowed),
            },
        };
        self.failed.store(0, Relaxed);
        if let Some(most) = chip.frozen_after {
            let is_equal = count == self.count();
            let equal = if is_equal { self.equal.load(Relaxed).saturating_add(1) } else { 0 };
            self.equal.store(equal, Relaxed);
            if equal >= most {
                return Err(ReadingError::Frozen);
            }
        }
        self.count.store(count, Relaxed);
        Ok(true)
    }

    /// The same for a transfer without an angle.
    ///
    /// # Errors
    /// If more transfers in a row have failed than are allowed.
    #[cold]
    #[inline(never)]
    pub fn fail(&self, error: ReadingError, allowed: u16) -> Result<bool, ReadingError> {
        let failed = self.failed.load(Relaxed).saturating_add(1);
        self.failed.store(failed, Relaxed);
        if failed > allowed { Err(error) } else { Ok(false) }
    }

    /// Beside zero a word of equal bits is an angle: a handle may rest there.
    #[cold]
    #[inline(never)]
    fn near_zero(&self, chip: &Chip, error: ReadingError) -> Option<u32> {
        let (turn, near) = (chip.width.mask(), chip.width.mask() / NEAR);
        let last = self.count();
        if last == NONE || last.wrapping_add(near) & turn > 2 * near {
            return None;
        }
        match error {
            ReadingError::Zeros => Some(0),
            ReadingError::Ones if chip.ones_are_angle => Some(turn),
            _ => None,
        }
    }

    /// The last angle in counts; in a turn of the chip zero if there was none yet.
    #[inline(always)]
    pub fn count(&self) -> u32 {
        self.count.load(Relaxed)
    }
}
