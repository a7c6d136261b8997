//! The readings of a chip, tick by tick: the angle, or for some failed transfers the angle before.

use super::{Chip, Frame, ReadingError};

/// The last angle, and what has come since.
#[derive(Clone, Copy, Debug)]
pub struct Readings {
    /// The last angle in counts.
    count: u32,
    /// Failed transfers in a row, and the most that are allowed.
    failed: u16,
    allowed: u16,
    /// Equal angles in a row.
    equal: u16,
    /// Whether there was an angle.
    has_begun: bool,
}

/// The part of a turn to either side of zero in which words of equal bits are angles.
const NEAR: u32 = 256;

impl Readings {
    /// Readings of which so many in a row may fail, as the scene's certificate says.
    pub const fn new(allowed: u16) -> Self {
        Self { count: 0, failed: 0, allowed, equal: 0, has_begun: false }
    }

    /// Takes a transfer. A failed one is replaced by the angle before.
    ///
    /// # Errors
    /// If more transfers in a row have failed than are allowed, or if the chip has stopped.
    #[inline(always)]
    pub fn take(&mut self, chip: &Chip, frame: &Frame) -> Result<(), ReadingError> {
        let count = match self.near_zero(chip, (chip.decode)(frame)) {
            Ok(count) => count,
            Err(error) => {
                self.failed = self.failed.saturating_add(1);
                return if self.failed > self.allowed { Err(error) } else { Ok(()) };
            }
        };
        self.failed = 0;
        if let Some(most) = chip.frozen_after {
            self.equal = if count == self.count { self.equal.saturating_add(1) } else { 0 };
            if self.equal >= most {
                return Err(ReadingError::Frozen);
            }
        }
        (self.count, self.has_begun) = (count, true);
        Ok(())
    }

    /// Beside zero a word of equal bits is an angle: a handle may rest there.
    #[inline(always)]
    fn near_zero(&self, chip: &Chip, read: Result<u32, ReadingError>) -> Result<u32, ReadingError> {
        let error = match read {
            Err(error @ (ReadingError::Zeros | ReadingError::Ones)) => error,
            other => return other,
        };
        let (turn, near) = (chip.width.mask(), chip.width.mask() / NEAR);
        let is_near = self.has_begun && self.count.wrapping_add(near) & turn <= 2 * near;
        match error {
            ReadingError::Zeros if is_near => Ok(0),
            ReadingError::Ones if is_near && chip.ones_are_angle => Ok(turn),
            _ => Err(error),
        }
    }

    /// The last angle in counts.
    #[inline(always)]
    pub const fn count(&self) -> u32 {
        self.count
    }
}
