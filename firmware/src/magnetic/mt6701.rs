//! MT6701 of MagnTek, by its serial interface (SSI).
//!
//! A transfer of 24 bits has 14 bits of angle, 4 of status and a checksum of 6 over both. It only reads: clock, data,
//! and the wire that selects the chip.

use super::checksum::Checksum;
use super::{Chip, Frame, Interface, ReadingError, Remainder};
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
    diagnosis: None,
    start_up: 0.05,
    age: TimeRange::between(0.0, 1e-5),
    is_period_late: false,
    lag: TimeRange::ZERO,
    frozen_after: None,
    ones_are_angle: false,
    checksum: None,
    decode,
};

/// Status: the field is too strong (1), too weak (2), or the track is lost (8). The push button (4) is no error.
const FIELD: u32 = 0b1011;

/// By x^6 + x + 1.
const CHECKSUM: Checksum = Checksum { polynomial: 0x43, bits: 18 };

/// Angles in a turn.
const ANGLES: usize = 1 << 14;

/// The checksum of each angle without a status, so that one comparison checks a transfer: 16 kB.
static CHECKSUMS: [u8; ANGLES] = CHECKSUM.table(4);

/// The same by the upper and the lower half of an angle, in 256 bytes.
const HALVES: [[u8; 128]; 2] = [CHECKSUM.table(11), CHECKSUM.table(4)];

/// [`CHECKSUMS`] where flash is short.
const fn checksum_of_halves(angle: usize) -> u8 {
    HALVES[0][angle >> 7] ^ HALVES[1][angle & 0x7F]
}

/// The checksum of an angle: the program of a bridge leaves no room for the table.
#[inline(always)]
fn checksum_of(angle: usize) -> u8 {
    if cfg!(feature = "bridge") { checksum_of_halves(angle) } else { CHECKSUMS[angle] }
}

/// The same of each status.
const OF_STATUS: [u8; 16] = CHECKSUM.table(0);

#[inline(always)]
fn decode(&[first, second, _]: &Frame, _: Remainder) -> Result<u32, ReadingError> {
    let bits = u32::from(first) << 12 | u32::from(second);
    if bits == 0 {
        // The checksum of zeros is zero.
        return Err(ReadingError::Zeros);
    }
    let angle = (bits >> 10) as usize % ANGLES;
    if u16::from(checksum_of(angle)) == second & 0x3FF { Ok(angle as u32) } else { unusual(bits) }
}

/// The angle of a transfer with a status.
#[cold]
#[inline(never)]
fn unusual(bits: u32) -> Result<u32, ReadingError> {
    let (angle, status) = (bits >> 10, bits >> 6 & 0xF);
    let of_angle = checksum_of(angle as usize % ANGLES);
    match bits {
        // The checksum of ones is none.
        0xFF_FFFF => Err(ReadingError::Ones),
        _ if u32::from(of_angle ^ OF_STATUS[status as usize]) != bits & 0x3F => {
            Err(ReadingError::Checksum)
        }
        _ if status & FIELD != 0 => Err(ReadingError::Field),
        _ => Ok(angle),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_of_an_angle_have_its_checksum() {
        assert!((0..ANGLES).all(|angle| checksum_of_halves(angle) == CHECKSUMS[angle]));
    }
}
