//! DAC3 (RM0440, 22.7), whose two channels have no pin: they are the comparators' thresholds.

use super::{Access, Unmodelled, only};

/// CR: each channel; MCR: each channel is on the chip alone, without a buffer.
const ENABLES: u32 = 1 | 1 << 16;
const ON_CHIP: u32 = 0b011 | 0b011 << 16;
const MODES: u32 = 0b111 | 0b111 << 16;
/// MCR: the range of bus clocks, which has no effect on codes.
const CLOCK_RANGE: u32 = 0b11 << 14;
/// SR: each channel is ready, which it is at once.
const READY: u32 = 11;

/// The DAC.
#[derive(Clone, Copy, Debug, Default)]
pub struct ThresholdDac {
    control: u32,
    mode: u32,
    codes: [u32; 2],
}

impl ThresholdDac {
    /// The channels' voltages, as parts of the reference; zero if off.
    pub fn outputs(&self) -> [f64; 2] {
        [0, 1].map(|channel| {
            let is_on = self.control >> (16 * channel) & 1 != 0;
            let code = if is_on { self.codes[channel] } else { 0 };
            f64::from(code) / 4096.0
        })
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00 => Ok(self.control),
            0x08 => Ok(self.codes[0]),
            0x14 => Ok(self.codes[1]),
            0x2C | 0x30 => Ok(self.codes[(offset as usize - 0x2C) / 4]),
            0x34 => Ok(self.control << READY),
            0x3C => Ok(self.mode),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => {
                only(value, ENABLES)?;
                if value != 0 && self.mode & MODES != ON_CHIP {
                    return Err(Unmodelled::Bits(value));
                }
                self.control = value;
            }
            0x08 | 0x14 => {
                only(value, 0xFFF)?;
                self.codes[usize::from(offset == 0x14)] = value;
            }
            0x3C => {
                only(value, ON_CHIP | CLOCK_RANGE)?;
                self.mode = value;
            }
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_puts_its_code_out_at_once() {
        let mut dac = ThresholdDac::default();
        for (register, value) in [(0x3C, ON_CHIP | 0b10 << 14), (0x08, 1024), (0x14, 512)] {
            dac.write(register, value).unwrap();
        }
        assert_eq!(dac.outputs(), [0.0, 0.0]);
        dac.write(0x00, ENABLES).unwrap();
        assert_eq!(dac.outputs(), [0.25, 0.125]);
        assert_eq!(dac.read(0x34), Ok(1 << 11 | 1 << 27));
    }

    #[test]
    fn a_channel_with_a_pin_or_a_trigger_is_not_modelled() {
        let mut dac = ThresholdDac::default();
        assert!(dac.write(0x00, 1).is_err(), "with its buffer, as out of reset");
        dac.write(0x3C, ON_CHIP).unwrap();
        assert!(dac.write(0x00, 0b11).is_err(), "triggered");
        assert!(dac.write(0x20, 0).is_err());
    }
}
