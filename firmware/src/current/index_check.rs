//! The index of an encoder, which has to come where it came before.

use super::fault::PowerFault;
use super::phase::Turn;

/// Counts by which the index may be off: its pulse is as wide, and is met from both sides.
pub(super) const WIDTH: u32 = 4;

/// Compares the counts at which the index comes. The first one since it was last forgotten is the reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct IndexCheck {
    /// Where the index came first.
    reference: Option<Turn>,
}

impl IndexCheck {
    /// No index has come.
    pub(super) const NOT_SEEN: Self = Self { reference: None };

    /// Where the handle is in its turn at the index.
    pub(super) const fn reference(&self) -> Option<Turn> {
        self.reference
    }

    /// Takes where the handle was in its turn when an index came.
    ///
    /// # Errors
    /// Where that is another place.
    pub(super) const fn observe(&mut self, at: Turn) -> Result<(), PowerFault> {
        let Some(reference) = self.reference else {
            self.reference = Some(at);
            return Ok(());
        };
        let (count, aligned) = (at.count().cast_unsigned(), reference.count().cast_unsigned());
        let apart = count.abs_diff(aligned);
        // Either way round the turn.
        let other_way = at.counts().saturating_sub(apart);
        if apart <= WIDTH || other_way <= WIDTH {
            Ok(())
        } else {
            Err(PowerFault::IndexMismatch { count, aligned })
        }
    }
}
