//! The transfers of the AS504x of ams: a word of 16 bits with an even parity, an error flag and 14 bits.
//!
//! A command is answered in the next transfer. By the data sheet of the AS5055A the chip samples the angle at the end
//! of the command's transfer; for the others this is not confirmed. One transfer in a period so reads an angle that
//! is up to a period older. The error flag sticks until register 1 is read.

use super::checksum::Checksum;
use super::{Frame, Interface, ReadingError, Remainder};

/// Clocked below its limit of 10 MHz.
pub const INTERFACE: Interface =
    Interface { words: 1, word_bits: 16, idle_high: false, highest_clock: 10e6 };

/// Reads register 1, which clears the error flag.
pub const CLEAR_ERRORS: Frame = [0x4001, 0, 0];

const ANGLE: u16 = (1 << 14) - 1;

/// The parity of each angle, as the two bits above it have it where there is no error: 16 kB. A word of zeros, whose
/// parity is right, has none.
static PARITIES: [u8; 1 << 14] = {
    let mut table = [NONE; 1 << 14];
    each!(angle in 1..1 << 14 => {
        table[angle] = parity(angle as u16);
    });
    table
};

/// No parity.
const NONE: u8 = u8::MAX;

const fn parity(angle: u16) -> u8 {
    if angle == 0 { NONE } else { (angle.count_ones() % 2 * 2) as u8 }
}

/// That parity: the program of a bridge leaves no room for the table.
#[inline(always)]
fn parity_of(angle: u16) -> u8 {
    if cfg!(feature = "bridge") { parity(angle) } else { PARITIES[usize::from(angle)] }
}

/// The angle of a word.
#[inline(always)]
pub fn decode(&[word, ..]: &Frame, _: Remainder) -> Result<u32, ReadingError> {
    let angle = word & ANGLE;
    match word {
        _ if word >> 14 == u16::from(parity_of(angle)) => Ok(angle.into()),
        0 => Err(ReadingError::Zeros),
        _ => Err(error(word)),
    }
}

#[cold]
#[inline(never)]
fn error(word: u16) -> ReadingError {
    match word {
        // Its parity is even, too.
        u16::MAX => ReadingError::Ones,
        _ if !word.count_ones().is_multiple_of(2) => ReadingError::Parity,
        _ => ReadingError::Flag,
    }
}

/// Of the registers with diagnostics: the field is too weak or too strong, or the angle is out of range. The gain of an
/// AS504x follows the field, and no angle has its state.
const MAGNET: u32 = 0b111 << 9;

/// Checks the answer of the register with diagnostics. Not confirmed: that its bits 9 to 11 are these for both chips.
pub fn check_magnet(frame: &Frame) -> Result<(), ReadingError> {
    match decode(frame, Checksum::remainder) {
        Ok(state) if state & MAGNET == 0 => Ok(()),
        Ok(_) => Err(ReadingError::Field),
        Err(error) => Err(error),
    }
}
