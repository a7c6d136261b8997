//! MagAlpha sensors of MPS: each word of 16 bits is an angle, whatever is sent, and nothing checks it.
//!
//! A transfer has no checksum, no parity and no status, so that only a broken wire is seen: all bits 0, all bits 1,
//! or the same word for long.

use super::{Chip, Frame, Interface, ReadingError, Remainder};
use crate::encoder::CounterWidth;
use crate::time_range::TimeRange;

/// MA600 with a filter window of at most 40 us (FW 0 or 5). Not confirmed: that this filter is a first-order lag, as
/// "no latency" on its page may be that of a tracking filter; its noise, which is more than a count only with such a
/// window; its time to start.
pub const MA600: Chip = Chip {
    name: "ma600",
    age: TimeRange::between(0.0, 2e-6),
    lag: TimeRange::between(0.0, 4e-5),
    ..MA702
};

/// MA702. Not confirmed: its cut-off frequency of 3 kHz, whose lag this is, and its age. That the angle stands while
/// the chip is selected is of the data sheet of the MA300.
pub const MA702: Chip = Chip {
    name: "ma702",
    width: CounterWidth::Bits16,
    // Up to 25 MHz by the data sheet of the MA300; slower for the sake of the wires.
    interface: Interface { words: 1, word_bits: 16, idle_high: true, highest_clock: 12e6 },
    command: [0; 3],
    set_up: &[],
    diagnosis: None,
    start_up: 0.3,
    age: TimeRange::between(3e-6, 1.3e-5),
    is_period_late: false,
    lag: TimeRange::exactly(5.3e-5),
    // More than a count of 16 bits of noise, by its resolution.
    frozen_after: Some(100),
    ones_are_angle: true,
    checksum: None,
    decode,
};

/// MA732 with a filter window of 64 us (FW 51). Not confirmed: its age.
pub const MA732: Chip = Chip {
    name: "ma732",
    age: TimeRange::between(3e-6, 1e-5),
    lag: TimeRange::exactly(6.4e-5),
    ..MA702
};

#[inline(always)]
fn decode(&[word, ..]: &Frame, _: Remainder) -> Result<u32, ReadingError> {
    match word {
        0 => Err(ReadingError::Zeros),
        u16::MAX => Err(ReadingError::Ones),
        angle => Ok(angle.into()),
    }
}
