//! The detector of edges (RM0440, EXTI), of which programs use the lines of pins, by the falling edge.

use super::registers::{Registers, Table};
use super::{Access, only};

/// IMR1, FTSR1 and PR1.
const MASK: u32 = 0x00;
const FALLING: u32 = 0x0C;
const PENDING: u32 = 0x14;

/// The lines of pins.
const PINS: u32 = 0xFFFF;

/// The lines that are not of pins are direct ones, and enabled out of reset.
const REGISTERS: Table = &[(MASK, 0xFF82_0000, PINS), (FALLING, 0, PINS)];

/// The unit.
#[derive(Clone, Debug)]
pub struct Edges {
    registers: Registers,
    /// When each line's edge was last taken away.
    cleared: [u64; 16],
}

impl Default for Edges {
    /// The unit after reset.
    fn default() -> Self {
        Self { registers: Registers::new(REGISTERS), cleared: [0; 16] }
    }
}

impl Edges {
    /// Reads, with the pin that has fallen last, if one is connected, and when.
    pub fn read(&self, offset: u32, fallen: Option<(u32, u64)>) -> Access<u32> {
        if offset != PENDING {
            return self.registers.read(offset);
        }
        let is_pending = |(pin, at): &(u32, u64)| {
            self.registers.has(FALLING, 1 << pin) && *at > self.cleared[*pin as usize]
        };
        Ok(fallen.filter(is_pending).map_or(0, |(pin, _)| 1 << pin))
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Access<()> {
        if offset != PENDING {
            return self.registers.write(offset, value);
        }
        only(value, PINS)?;
        for (line, cleared) in self.cleared.iter_mut().enumerate() {
            if value >> line & 1 != 0 {
                *cleared = now;
            }
        }
        Ok(())
    }
}
