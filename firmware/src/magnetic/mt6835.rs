//! MT6835 of MagnTek, by a burst over its registers from 3 on.
//!
//! After the command of 16 bits come 21 bits of angle, 3 of status and a checksum of 8 over both.

use super::checksum::Checksum;
use super::{Chip, Frame, Interface, ReadingError, Remainder};
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
    frozen_after: Some(100),
    ones_are_angle: false,
    checksum: Some(CHECKSUM),
    decode,
};

/// Status: the field is too weak. The others are too fast a turn (1) and too low a supply (4).
const FIELD: u32 = 0b010 << 8;

/// The status, where the second word is above the first, as they come.
const STATUS: u32 = 0b111 << 24;

/// By x^8 + x^2 + x + 1.
const CHECKSUM: Checksum = Checksum { polynomial: 0x107, bits: 24 };

/// One comparison finds a status, a wrong checksum, and bits that are all 0, whose checksum is right: less one, they
/// have a status. Others less one have the status that they had, unless the first word and the checksum are 0, which a
/// checksum of the 8 bits that are left is for zeros alone.
#[inline(always)]
fn decode(&[_, first, second]: &Frame, remainder: Remainder) -> Result<u32, ReadingError> {
    let words = u32::from(second) << 16 | u32::from(first);
    let bits = words.rotate_left(16);
    let rest = remainder(&CHECKSUM, bits);
    match bits {
        _ if rest | words.wrapping_sub(1) & STATUS == 0 => Ok(bits >> 11),
        0 => Err(ReadingError::Zeros),
        _ => Err(error(bits, rest)),
    }
}

/// The error of a transfer with a status, or with a remainder.
#[cold]
#[inline(never)]
fn error(bits: u32, rest: u32) -> ReadingError {
    match bits {
        // The checksum of ones is none.
        u32::MAX => ReadingError::Ones,
        _ if rest != 0 => ReadingError::Checksum,
        _ if bits & FIELD != 0 => ReadingError::Field,
        _ => ReadingError::Flag,
    }
}
