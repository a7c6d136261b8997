//! The readings of a chip, tick by tick: the angle, or for some failed transfers the angle before.

use core::hint::cold_path;

use super::{Checksum, Chip, Frame, ReadingError, Remainder};

/// A transfer that has no angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unread {
    /// The angle before takes its place.
    Held,
    /// More in a row have failed than are allowed.
    Fault(ReadingError),
}

/// What a board knows of a transfer beside its words.
pub trait Receiver {
    /// The remainder of its bits.
    const REMAINDER: Remainder = Checksum::remainder;
    /// Whether the data line has fallen in it, asked after a word of zeros.
    fn has_fallen(&self) -> bool;
    /// It has failed.
    fn fail(&self, _chip: &Chip) {}
}

/// The last angle, and what has come since.
#[derive(Clone, Debug)]
pub struct Readings {
    /// The last angle in counts, with [`FAILED`], or [`NONE`].
    count: u32,
    /// Failed transfers in a row, if the angle says that one has failed: so a good one has nothing to reset.
    failed: u16,
}

/// Beside the last angle: the last transfer has failed. No chip has as many bits.
const FAILED: u32 = 1 << 31;
/// In its place: there was none yet. In a turn of any chip that is zero.
const NONE: u32 = 1 << 29;

/// The part of a turn to either side of zero in which words of ones are angles.
const NEAR: u32 = 256;

impl Readings {
    /// No reading yet.
    pub const fn none() -> Self {
        Self { count: NONE, failed: 0 }
    }

    /// Takes a transfer, of which so many in a row may fail, as the scene's certificate says.
    ///
    /// # Errors
    /// If it has no angle.
    #[inline(always)]
    pub fn take<R: Receiver>(
        &mut self,
        chip: &Chip,
        frame: &Frame,
        allowed: u16,
        receiver: R,
    ) -> Result<(), Unread> {
        // A word of zeros is an angle, and a handle may rest there. No checksum tells it from a wire at ground, but the
        // line does: it is pulled up, high while the chip is not selected, and falls for such a word. A line that
        // nothing drives is as high as a word of ones. So these are an angle only beside zero, and until the chip
        // counts as frozen.
        let count = match (chip.decode)(frame, R::REMAINDER) {
            Ok(count) => count,
            Err(error) => {
                cold_path();
                let has_angle = chip.ones_are_angle && self.count & NONE == 0;
                match error {
                    ReadingError::Zeros if receiver.has_fallen() => 0,
                    ReadingError::Ones if has_angle && self.is_near_zero(chip) => chip.width.mask(),
                    _ => {
                        receiver.fail(chip);
                        return Err(self.fail(error, allowed));
                    }
                }
            }
        };
        self.count = count;
        Ok(())
    }

    /// Takes a transfer without an angle.
    #[cold]
    #[inline(never)]
    pub fn fail(&mut self, error: ReadingError, allowed: u16) -> Unread {
        let before = if self.count & FAILED == 0 { 0 } else { self.failed };
        self.failed = before.saturating_add(1);
        self.count |= FAILED;
        if self.failed > allowed { Unread::Fault(error) } else { Unread::Held }
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

/// Ticks without a step, of which the noise of a chip rules out so many in a row.
#[derive(Clone, Debug, Default)]
pub struct Rests {
    /// Such ticks after the tick of this number.
    ticks: u32,
    since: u32,
}

impl Rests {
    /// Takes the number of a tick without a step; whether the chip has stopped. Whether they are in a row is asked once
    /// for so many, which makes one cheap, and finds a chip that has stopped after at most twice as many.
    #[inline(always)]
    pub const fn take(&mut self, tick: u32, ruled_out: u32) -> bool {
        cold_path();
        self.ticks = self.ticks.wrapping_add(1);
        if self.ticks < ruled_out {
            return false;
        }
        let in_a_row = tick.wrapping_sub(self.since) == self.ticks;
        if !in_a_row {
            (self.ticks, self.since) = (0, tick);
        }
        in_a_row
    }

    /// Whether the last one has shown that the chip has stopped.
    pub const fn are(&self, ruled_out: u32) -> bool {
        self.ticks >= ruled_out
    }

    /// So many numbers belong to no tick: the next one follows the last.
    pub const fn miss(&mut self, ticks: u32) {
        self.since = self.since.wrapping_add(ticks);
    }
}
