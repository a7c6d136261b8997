//! MT6835 of MagnTek, by a burst over its registers from 3 on.
//!
//! After the command of 16 bits come 21 bits of angle, 3 of status and a checksum of 8 over both.

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

/// The checksums by x^8 + x^2 + x + 1 of the bytes of 24 bits, each with the bytes behind it zero.
static CHECKSUMS: [[u8; 256]; 3] = {
    let mut table = [[0; 256]; 3];
    each!(place in 0..3 => {
        each!(byte in 0..256 => {
            let mut rest = (byte as u32) << (24 - 8 * place);
            each!(bit in 0..24 => {
                if rest & (1_u32 << 31) >> bit != 0 {
                    rest ^= (0x107_u32 << 23) >> bit;
                }
            });
            table[place][byte] = rest as u8;
        });
    });
    table
};

/// The checksum of 24 bits.
#[inline(always)]
fn checksum(content: u32) -> u32 {
    let [_, first, second, third] = content.to_be_bytes();
    let of = |place: usize, byte: u8| CHECKSUMS[place][usize::from(byte)];
    (of(0, first) ^ of(1, second) ^ of(2, third)).into()
}

#[inline(always)]
fn decode(&[_, first, second]: &Frame) -> Result<u32, ReadingError> {
    let bits = u32::from(first) << 16 | u32::from(second);
    if bits == 0 {
        // The checksum of zeros is zero.
        return Err(ReadingError::Zeros);
    }
    let content = bits >> 8;
    if checksum(content) != bits & 0xFF {
        // The checksum of ones is none.
        return Err(if bits == u32::MAX { ReadingError::Ones } else { ReadingError::Checksum });
    }
    match content & 0b111 {
        0 => Ok(content >> 3),
        status if status & FIELD != 0 => Err(ReadingError::Field),
        _ => Err(ReadingError::Flag),
    }
}
