//! A port of pins (RM0440, 9.4; RM0090, 8.4): what the program sets each to, and the level of its
//! outputs.

use super::{Access, Unmodelled};

/// IDR.
pub const INPUT: u32 = 0x10;

/// Registers that say what pins are for: MODER, OTYPER, OSPEEDR, PUPDR, AFRL, AFRH.
const MODE: usize = 0;
const PULLS: usize = 3;

/// A port.
#[derive(Clone, Debug)]
pub struct Pins {
    config: [u32; 6],
    output: u32,
}

/// What a pin is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Level {
    /// Nothing drives it.
    #[default]
    Floating,
    /// 0 V.
    Low,
    /// 3.3 V.
    High,
}

impl Pins {
    /// A port whose pins are for this out of reset, by its MODER, OSPEEDR and PUPDR.
    pub fn new(modes: u32, speeds: u32, pulls: u32) -> Self {
        Self { config: [modes, 0, speeds, pulls, 0, 0], output: 0 }
    }

    /// Level that the port gives a pin.
    pub fn level(&self, pin: u32) -> Level {
        const OUTPUT: u32 = 0b01;
        match (self.config[MODE] >> (2 * pin) & 0b11, self.output >> pin & 1) {
            (OUTPUT, 0) => Level::Low,
            (OUTPUT, _) => Level::High,
            _ => Level::Floating,
        }
    }

    /// The alternate function of a pin; none where it has another purpose.
    pub fn function(&self, pin: u32) -> Option<u32> {
        const ALTERNATE: u32 = 0b10;
        let chosen = self.config[4 + pin as usize / 8] >> (4 * (pin % 8)) & 0xF;
        (self.config[MODE] >> (2 * pin) & 0b11 == ALTERNATE).then_some(chosen)
    }

    /// Whether the chip pulls a pin up or down.
    pub fn is_pulled(&self, pin: u32) -> bool {
        self.config[PULLS] >> (2 * pin) & 0b11 != 0
    }

    /// Whether a pin is analog.
    pub fn is_analog(&self, pin: u32) -> bool {
        self.config[MODE] >> (2 * pin) & 0b11 == 0b11
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00..=0x0C => Ok(self.config[offset as usize / 4]),
            0x14 => Ok(self.output),
            0x20 | 0x24 => Ok(self.config[4 + (offset as usize - 0x20) / 4]),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00..=0x0C => self.config[offset as usize / 4] = value,
            0x14 => self.output = value & 0xFFFF,
            // Set in the lower half, cleared in the upper; setting wins.
            0x18 => self.output = self.output & !(value >> 16) | value & 0xFFFF,
            0x20 | 0x24 => self.config[4 + (offset as usize - 0x20) / 4] = value,
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }
}
