//! MT6701 of MagnTek, by its serial interface (SSI).
//!
//! A transfer of 24 bits has 14 bits of angle, 4 of status and a checksum of 6 over both. It only reads: clock, data,
//! and the wire that selects the chip.

use super::{Chip, Frame, Interface, ReadingError};
use crate::encoder::CounterWidth;
use crate::time_range::TimeRange;

/// MT6701. Not confirmed: its update, by which an angle is up to 10 us old; that it samples where it is selected; its
/// noise, which may be less than a count, so that nothing tells a frozen angle from one at rest; its time to start.
pub const MT6701: Chip = Chip {
    name: "mt6701",
    width: CounterWidth::Bits14,
    // Data change at the rising edge. The limit of its data sheet, 15.6 MHz, is not confirmed; 10 MHz is in use.
    interface: Interface { words: 2, word_bits: 12, idle_high: false, highest_clock: 10e6 },
    command: [0; 3],
    set_up: &[],
    start_up: 0.05,
    age: TimeRange::between(0.0, 1e-5),
    is_period_late: false,
    lag: TimeRange::ZERO,
    frozen_after: None,
    ones_are_angle: false,
    decode,
};

/// Status: the field is too strong (1), too weak (2), or the track is lost (8). The push button (4) is no error.
const FIELD: u32 = 0b1011;

/// The remainder by x^6 + x + 1 of 18 bits, of which the last are these, with the checksum's six zeros behind them.
const fn remainder(bits: u32) -> u8 {
    let mut rest = bits << 6;
    each!(bit in 0..18 => {
        if rest & (1 << 23) >> bit != 0 {
            rest ^= (0x43 << 17) >> bit;
        }
    });
    rest as u8
}

/// Of the first word of 12 bits the remainder, and of the second the remainder that goes with it, or [`NO_ANGLE`]: 8 kB,
/// so that a transfer is checked by one comparison.
static REMAINDERS: [[u8; 1 << 12]; 2] = {
    let mut table = [[0; 1 << 12]; 2];
    each!(word in 0..1 << 12 => {
        let bits = word as u32;
        table[0][word] = remainder(bits << 6);
        let is_angle = bits >> 6 & FIELD == 0;
        table[1][word] = if is_angle { remainder(bits >> 6) ^ (bits & 0x3F) as u8 } else { NO_ANGLE };
    });
    table
};

/// No remainder.
const NO_ANGLE: u8 = 0xFF;

#[inline(always)]
fn decode(&[first, second, _]: &Frame) -> Result<u32, ReadingError> {
    let [of_first, of_second] = &REMAINDERS;
    let at = |word: u16| usize::from(word) & 0xFFF;
    if of_first[at(first)] != of_second[at(second)] {
        return Err(failure(first, second));
    }
    // The status of the push button may be beside a zero.
    match u32::from(first) << 2 | u32::from(second) >> 10 {
        0 if second == 0 => Err(ReadingError::Zeros),
        angle => Ok(angle),
    }
}

#[cold]
#[inline(never)]
fn failure(first: u16, second: u16) -> ReadingError {
    let bits = u32::from(first) << 12 | u32::from(second);
    let is_checked = remainder(bits >> 6) == (bits & 0x3F) as u8;
    match bits {
        0xFF_FFFF => ReadingError::Ones,
        _ if is_checked => ReadingError::Field,
        _ => ReadingError::Checksum,
    }
}
