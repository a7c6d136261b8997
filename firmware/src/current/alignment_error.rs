//! Reasons why a motor could not be aligned.

use core::fmt;

/// The reason why a motor could not be aligned. Counts are per electrical turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlignmentError {
    /// The board cannot turn the motor's field: the motor is brushed, or behind an external amplifier.
    NotNeeded,
    /// The handle did not move.
    Blocked {
        /// Counts that it moved.
        moved: i32,
        /// Counts of an electrical turn.
        expected: i32,
    },
    /// The handle moved, but not by an electrical turn.
    PolePairs {
        /// Counts that it moved.
        moved: i32,
        /// Counts of an electrical turn.
        expected: i32,
    },
    /// The handle did not return by the same number of counts.
    NotReturned {
        /// Counts that it moved.
        moved: i32,
        /// Counts that it moved back.
        returned: i32,
    },
    /// The positions of the stops do not fit a turning field.
    Uneven {
        /// The largest deviation in degrees of an electrical turn.
        degrees: i32,
        /// The largest allowed deviation.
        largest: i32,
    },
}

impl AlignmentError {
    /// The error in one word, for tables.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::NotNeeded => "alignment-not-needed",
            Self::Blocked { .. } => "alignment-blocked",
            Self::PolePairs { .. } => "alignment-pole-pairs",
            Self::NotReturned { .. } => "alignment-not-returned",
            Self::Uneven { .. } => "alignment-uneven",
        }
    }

    /// The error as a code and two numbers, distinct from the codes of [`Fault`](crate::fault::Fault).
    pub(super) const fn encode(self) -> (u32, [u32; 2]) {
        let (code, [a, b]) = match self {
            Self::NotNeeded => (24, [0; 2]),
            Self::Blocked { moved, expected } => (25, [moved, expected]),
            Self::PolePairs { moved, expected } => (26, [moved, expected]),
            Self::NotReturned { moved, returned } => (27, [moved, returned]),
            Self::Uneven { degrees, largest } => (28, [degrees, largest]),
        };
        (code, [a.cast_unsigned(), b.cast_unsigned()])
    }

    /// The error of a code and its numbers; `None` if there is no such error.
    pub(super) const fn decode(code: u32, numbers: [u32; 2]) -> Option<Self> {
        let (a, b) = (numbers[0].cast_signed(), numbers[1].cast_signed());
        Some(match code {
            24 => Self::NotNeeded,
            25 => Self::Blocked { moved: a, expected: b },
            26 => Self::PolePairs { moved: a, expected: b },
            27 => Self::NotReturned { moved: a, returned: b },
            28 => Self::Uneven { degrees: a, largest: b },
            _ => return None,
        })
    }
}

impl fmt::Display for AlignmentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotNeeded => f.write_str(
                "this motor needs no alignment: it is brushed, or an amplifier outside turns its field",
            ),
            Self::Blocked { moved, expected } => write!(
                f,
                "the handle moved by {moved} counts, and an electrical turn has {expected}: release it, check \
                 the wires of motor and encoder, then align again"
            ),
            Self::PolePairs { moved, expected } => write!(
                f,
                "an electrical turn moved the handle by {moved} counts, and not by {expected}: check the pole \
                 pairs and the counts per turn, keep the hand off, then align again"
            ),
            Self::NotReturned { moved, returned } => write!(
                f,
                "the handle moved by {moved} counts and back by {returned}: keep the hand off, check the \
                 encoder's coupling, then align again"
            ),
            Self::Uneven { degrees, largest } => write!(
                f,
                "the handle settled {degrees} electrical degrees off the field, and {largest} are allowed: \
                 friction or cogging is too much for the current of the alignment"
            ),
        }
    }
}

impl core::error::Error for AlignmentError {}
