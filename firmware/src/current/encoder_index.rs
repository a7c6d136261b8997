//! The index of a brushless motor's encoder. With it, a motor that was aligned once need not be aligned after
//! each reset.

use super::phase::{PhaseAlignment, Turn};

/// An index that comes once per turn of the encoder, as a program states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderIndex {
    /// The motor's phase at the index, as the board reports it after an alignment. Without it the motor is
    /// aligned after each reset, and the index only detects lost counts.
    pub offset: Option<IndexOffset>,
}

/// The phase of a motor at its encoder's index. It is valid for this motor with its three wires in this order
/// and the encoder in this position on the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct IndexOffset {
    /// Electrical angle at the index in encoder counts, less than an electrical turn.
    pub counts: u32,
    /// Whether that angle falls while the count rises.
    pub is_reversed: bool,
}

impl IndexOffset {
    /// The offset of an aligned motor whose index is at this position in the turn.
    pub(super) const fn of(phase: PhaseAlignment, index: Turn) -> Self {
        let counts = index.electrical_counts(phase.angle(index.angle()));
        Self { counts, is_reversed: phase.is_reversed }
    }

    /// The phase of a motor with this offset whose index is at this position in the turn.
    pub(super) const fn phase(self, index: Turn) -> PhaseAlignment {
        let since_zero = PhaseAlignment { offset: 0, is_reversed: self.is_reversed };
        let offset = index.angle_of(self.counts).wrapping_sub(since_zero.angle(index.angle()));
        PhaseAlignment { offset, is_reversed: self.is_reversed }
    }
}
