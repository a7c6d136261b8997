//! A current loop with the phase of its motor from the encoder's index.

use super::current_loop::CurrentLoop;
use super::encoder_index::{EncoderIndex, IndexOffset};
use super::error::DriveError;
use super::motor::Winding;

/// Smallest number of encoder counts in an electrical turn with the phase from the index: its pulse is up to
/// [`WIDTH`](super::index_check::WIDTH) counts wide and comes from either side, and the offset is rounded by
/// up to half a count. With 256 counts the error is 0.11 rad, which reduces the torque by 0.6 per cent.
const LEAST_ELECTRICAL_COUNTS: f64 = 256.0;

impl CurrentLoop {
    /// The same loop with an index at the motor's encoder.
    ///
    /// # Errors
    /// If the motor is brushed, or the offset is not within a turn of its encoder.
    pub const fn indexed(mut self, index: EncoderIndex) -> Result<Self, DriveError> {
        let Winding::Brushless { .. } = self.winding else {
            return Err(DriveError::IndexNotNeeded);
        };
        if let Some(offset) = index.offset {
            let counts = self.turn.counts_per_electrical_turn();
            if (counts as f64) < LEAST_ELECTRICAL_COUNTS {
                let least = LEAST_ELECTRICAL_COUNTS;
                return Err(DriveError::IndexCounts { counts: counts as f64, least });
            }
            if offset.counts as f64 >= counts as f64 {
                return Err(DriveError::IndexOffset {
                    offset: offset.counts,
                    counts: counts as f64,
                });
            }
        }
        self.index = Some(index);
        Ok(self)
    }

    /// For constants: a compile error if the index does not fit this motor's encoder.
    ///
    /// # Panics
    /// If it does not fit; in a constant this is a compile error.
    #[must_use]
    #[track_caller]
    pub const fn with_index(self, index: EncoderIndex) -> Self {
        match self.indexed(index) {
            Ok(indexed) => indexed,
            Err(error) => error.refuse(),
        }
    }

    /// Whether the program states an index.
    pub const fn has_index(&self) -> bool {
        self.index.is_some()
    }

    /// The phase of the motor at the index, if the program states it.
    pub const fn index_offset(&self) -> Option<IndexOffset> {
        match self.index {
            Some(index) => index.offset,
            None => None,
        }
    }
}
