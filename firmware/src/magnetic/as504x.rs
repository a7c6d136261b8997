//! The transfers of the AS504x of ams: a word of 16 bits with an even parity, an error flag and 14 bits.
//!
//! A command is answered in the next transfer. By the data sheet of the AS5055A the chip samples the angle at the end
//! of the command's transfer; for the others this is not confirmed. One transfer in a period so reads an angle that
//! is up to a period older. The error flag sticks until register 1 is read.

use super::{Frame, Interface, ReadingError};

/// Clocked below its limit of 10 MHz.
pub const INTERFACE: Interface =
    Interface { words: 1, word_bits: 16, idle_high: false, highest_clock: 10e6 };

/// Reads register 1, which clears the error flag.
pub const CLEAR_ERRORS: Frame = [0x4001, 0, 0];

const ERROR: u16 = 1 << 14;
const ANGLE: u16 = ERROR - 1;

/// The angle of a word.
#[inline(always)]
pub fn decode(&[word, ..]: &Frame) -> Result<u32, ReadingError> {
    match word {
        // Both have an even parity.
        0 => Err(ReadingError::Zeros),
        u16::MAX => Err(ReadingError::Ones),
        _ if word.count_ones() % 2 != 0 => Err(ReadingError::Parity),
        _ if word & ERROR != 0 => Err(ReadingError::Flag),
        _ => Ok((word & ANGLE).into()),
    }
}

/// Of the registers with diagnostics: the field is too weak or too strong, or the angle is out of range. The gain of an
/// AS504x follows the field, and no angle has its state.
const MAGNET: u32 = 0b111 << 9;

/// Checks the answer of the register with diagnostics. Not confirmed: that its bits 9 to 11 are these for both chips.
pub fn check_magnet(frame: &Frame) -> Result<(), ReadingError> {
    match decode(frame) {
        Ok(state) if state & MAGNET == 0 => Ok(()),
        Ok(_) => Err(ReadingError::Field),
        Err(error) => Err(error),
    }
}
