//! The index of a brushless motor's encoder, by which a motor that was aligned once need not be aligned after
//! each reset.

use super::current_loop::CurrentLoop;
use super::error::DriveError;
use super::motor::Winding;
use super::phase::{PhaseAlignment, Turn};

/// Encoder counts in an electrical turn, at the least, where the phase comes from the index: its pulse is up to
/// [`WIDTH`](super::index_check::WIDTH) counts wide and is met from either side, and the offset is rounded by
/// half a one. Of 256 counts that is 0.11 rad, which takes 0.6 per cent of the torque.
const LEAST_ELECTRICAL_COUNTS: f64 = 256.0;

/// An index that comes once in a turn of the encoder: what a program states of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderIndex {
    /// Where the motor's phase is at the index, as the board has told it after an alignment. Without it the
    /// motor is aligned after each reset, and the index shows lost counts only.
    pub offset: Option<IndexOffset>,
}

/// The phase of a motor at its encoder's index. It belongs to this motor, its three wires in this order, and
/// the encoder as it sits on the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct IndexOffset {
    /// Electrical angle at the index, in encoder counts: less than those of an electrical turn.
    pub counts: u32,
    /// Whether that angle falls while the count rises.
    pub is_reversed: bool,
}

impl CurrentLoop {
    /// The same loop with an index at the motor's encoder.
    ///
    /// # Errors
    /// Where the motor is brushed, or an offset is none of its encoder.
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

    /// For constants: a compile error where the index is none of this motor's encoder.
    ///
    /// # Panics
    /// If it is none; in a constant that is the compile error.
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

    /// The phase of the motor at the index, where the program states it.
    pub const fn index_offset(&self) -> Option<IndexOffset> {
        match self.index {
            Some(index) => index.offset,
            None => None,
        }
    }
}

impl IndexOffset {
    /// The offset of an aligned motor whose index is where the handle is in this turn.
    pub(super) const fn of(phase: PhaseAlignment, index: Turn) -> Self {
        let counts = index.electrical_counts(phase.angle(index.angle()));
        Self { counts, is_reversed: phase.is_reversed }
    }

    /// The phase of a motor with this offset whose index is where the handle is in this turn.
    pub(super) const fn phase(self, index: Turn) -> PhaseAlignment {
        let since_zero = PhaseAlignment { offset: 0, is_reversed: self.is_reversed };
        let offset = index.angle_of(self.counts).wrapping_sub(since_zero.angle(index.angle()));
        PhaseAlignment { offset, is_reversed: self.is_reversed }
    }
}
