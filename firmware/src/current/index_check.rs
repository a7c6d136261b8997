//! The index of an encoder, which has to stay where it was when the motor was aligned.

use super::fault::PowerFault;

/// Counts by which the index may be off: its pulse is as wide, and is met from both sides.
const WIDTH: u32 = 4;

/// Compares the counts at which the index comes.
#[derive(Clone, Copy, Debug)]
pub struct IndexCheck {
    counts: u32,
    aligned: Option<u32>,
}

impl IndexCheck {
    /// For an encoder with so many counts a turn, at least one; the first index is that of the alignment.
    pub const fn new(counts: u32) -> Self {
        Self { counts, aligned: None }
    }

    /// The same with an index that was stored.
    pub const fn stored(counts: u32, aligned: u32) -> Self {
        Self { counts, aligned: Some(aligned) }
    }

    /// The count of the alignment, to be stored.
    pub const fn aligned(&self) -> Option<u32> {
        self.aligned
    }

    /// Takes the count, within its turn, at which an index came.
    ///
    /// # Errors
    /// Where it is another one.
    pub const fn observe(&mut self, count: u32) -> Result<(), PowerFault> {
        let Some(aligned) = self.aligned else {
            self.aligned = Some(count);
            return Ok(());
        };
        let apart = count.abs_diff(aligned);
        // Either way round the turn.
        let other_way = self.counts.saturating_sub(apart);
        if apart <= WIDTH || other_way <= WIDTH {
            Ok(())
        } else {
            Err(PowerFault::IndexMismatch { count, aligned })
        }
    }
}
