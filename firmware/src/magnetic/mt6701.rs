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

/// The remainders of six more bits by x^6 + x + 1, with the first bit first.
const REMAINDERS: [u8; 64] = {
    let mut table = [0; 64];
    each!(bits in 0..64 => {
        let mut rest = bits as u8;
        each!(_bit in 0..6 => {
            rest = rest << 1 ^ if rest & 0x20 != 0 { 0x43 } else { 0 };
        });
        table[bits] = rest;
    });
    table
};

#[inline(always)]
fn decode(&[first, second, _]: &Frame) -> Result<u32, ReadingError> {
    let bits = u32::from(first) << 12 | u32::from(second);
    if bits == 0 {
        // The checksum of zeros is zero.
        return Err(ReadingError::Zeros);
    }
    let six = |rest: u8, bits: u32| REMAINDERS[(u32::from(rest) ^ bits & 0x3F) as usize];
    let rest = six(six(six(0, bits >> 18), bits >> 12), bits >> 6);
    if u32::from(rest) != bits & 0x3F {
        // The checksum of ones is none.
        return Err(if bits == 0xFF_FFFF { ReadingError::Ones } else { ReadingError::Checksum });
    }
    if bits >> 6 & FIELD != 0 {
        return Err(ReadingError::Field);
    }
    Ok(bits >> 10)
}
