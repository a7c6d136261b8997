//! MT6835 of MagnTek, by a burst over its registers from 3 on.
//!
//! After the command of 16 bits come 21 bits of angle, 3 of status and a checksum of 8 over both.

use super::checksum::Checksum;
use super::{Chip, Frame, Interface, ReadingError};
use crate::encoder::CounterWidth;
use crate::time_range::TimeRange;

/// MT6835 as it is delivered. Not confirmed: its age; the shape of its filter, which this takes for none; whether it
/// samples where it is selected or behind the command, 1.5 us later at 10.6 MHz, which the age covers; its noise and
/// its time to start.
pub const MT6835: Chip = Chip {
    name: "mt6835",
    width: CounterWidth::Bits21,
    interface: Interface { words: 3, word_bits: 16, idle_high: true, highest_clock: 16e6 },
    command: [0xA003, 0, 0],
    set_up: &[],
    diagnosis: None,
    start_up: 0.1,
    age: TimeRange::between(0.0, 1e-5),
    is_period_late: false,
    lag: TimeRange::ZERO,
    // Noise of tens of counts.
    frozen_after: Some(200),
    ones_are_angle: false,
    decode,
};

/// Status: the field is too weak. The others are too fast a turn (1) and too low a supply (4).
const FIELD: u32 = 0b010;

/// By x^8 + x^2 + x + 1.
const CHECKSUM: Checksum = Checksum { polynomial: 0x107, bits: 24 };

/// Bits of the lower part of an angle; the first word has the upper part on top.
const LOWER: u32 = 10;

/// The checksums of the upper and of the lower parts of angles without a status, so that one comparison checks a
/// transfer.
static OF_UPPER: [u8; 1 << 11] = CHECKSUM.table(LOWER + 3);
static OF_LOWER: [u8; 1 << LOWER] = CHECKSUM.table(3);

#[inline(always)]
fn decode(&[_, first, second]: &Frame) -> Result<u32, ReadingError> {
    let bits = u32::from(first) << 16 | u32::from(second);
    if bits == 0 {
        // The checksum of zeros is zero.
        return Err(ReadingError::Zeros);
    }
    let angle = bits >> 11;
    let lower = (angle % (1 << LOWER)) as usize;
    let checksum = OF_UPPER[usize::from(first >> 5)] ^ OF_LOWER[lower];
    if u16::from(checksum) == second & 0x7FF { Ok(angle) } else { Err(error(bits)) }
}

/// The error of a transfer with a status, or with a wrong checksum.
#[cold]
#[inline(never)]
fn error(bits: u32) -> ReadingError {
    let content = bits >> 8;
    if u32::from(CHECKSUM.of(content)) != bits & 0xFF {
        // The checksum of ones is none.
        return if bits == u32::MAX { ReadingError::Ones } else { ReadingError::Checksum };
    }
    if content & FIELD != 0 { ReadingError::Field } else { ReadingError::Flag }
}
