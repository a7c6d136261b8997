//! The unit for checksums (RM0440, CRC), of which programs use whole words and polynomials of 8 bits. Its times are not
//! modelled: a read waits for the word before it.

use super::registers::{Registers, Table};
use super::{Access, only};

/// CR, INIT and POL; DR is not stored.
const DATA: u32 = 0x00;
const CONTROL: u32 = 0x08;
const INITIAL: u32 = 0x10;
const POLYNOMIAL: u32 = 0x14;

/// In CR: begins anew, and the size of the polynomial, of which 2 is 8 bits.
const RESET: u32 = 1;
const SIZE: u32 = 0b11 << 3;
const BITS_8: u32 = 2 << 3;

const REGISTERS: Table =
    &[(CONTROL, 0, SIZE), (INITIAL, u32::MAX, u32::MAX), (POLYNOMIAL, 0x04C1_1DB7, u32::MAX)];

/// The unit.
#[derive(Clone, Debug)]
pub struct ChecksumUnit {
    registers: Registers,
    rest: u8,
}

impl Default for ChecksumUnit {
    /// The unit after reset.
    fn default() -> Self {
        Self { registers: Registers::new(REGISTERS), rest: u8::MAX }
    }
}

impl ChecksumUnit {
    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        if offset == DATA {
            self.is_of_8_bits()?;
            return Ok(self.rest.into());
        }
        self.registers.read(offset)
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            DATA => {
                self.is_of_8_bits()?;
                let polynomial = self.registers.get(POLYNOMIAL) as u8;
                for bit in (0..32).rev() {
                    let leaves = self.rest >> 7 ^ (value >> bit & 1) as u8;
                    self.rest = (self.rest << 1) ^ (leaves * polynomial);
                }
                Ok(())
            }
            CONTROL => {
                self.registers.write(CONTROL, value & !RESET)?;
                if value & RESET != 0 {
                    self.rest = self.registers.get(INITIAL) as u8;
                }
                Ok(())
            }
            _ => self.registers.write(offset, value),
        }
    }

    fn is_of_8_bits(&self) -> Access<()> {
        only(self.registers.get(CONTROL) ^ BITS_8, 0)
    }
}
