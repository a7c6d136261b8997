//! Checks that the index of an encoder always comes at the same count.

use super::fault::PowerFault;
use super::phase::Turn;

/// Tolerance of the index in counts: its pulse has up to this width, and comes from both sides.
pub(super) const WIDTH: u32 = 4;

/// Compares the counts of the index. The first index after a restart is the reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct IndexCheck {
    /// The position of the first index.
    reference: Option<Turn>,
}

impl IndexCheck {
    /// No index has come.
    pub(super) const NOT_SEEN: Self = Self { reference: None };

    /// The handle's position in its turn at the index.
    pub(super) const fn reference(&self) -> Option<Turn> {
        self.reference
    }

    /// Takes the handle's position in its turn at an index.
    ///
    /// # Errors
    /// If the position differs from the reference.
    pub(super) const fn observe(&mut self, at: Turn) -> Result<(), PowerFault> {
        let Some(reference) = self.reference else {
            self.reference = Some(at);
            return Ok(());
        };
        let (count, aligned) = (at.count().cast_unsigned(), reference.count().cast_unsigned());
        let apart = count.abs_diff(aligned);
        // The distance in either direction around the turn.
        let other_way = at.counts().saturating_sub(apart);
        if apart <= WIDTH || other_way <= WIDTH {
            Ok(())
        } else {
            Err(PowerFault::IndexMismatch { count, aligned })
        }
    }
}
