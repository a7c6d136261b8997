//! DAC3 (RM0440, 22.7), whose two channels have no pin: they are the comparators' thresholds.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled};

const CR: u32 = 0x00;
const DHR12R: [u32; 2] = [0x08, 0x14];
const DOR1: u32 = 0x2C;
const DOR2: u32 = 0x30;
const SR: u32 = 0x34;
const MCR: u32 = 0x3C;

/// CR: each channel; MCR: each channel is on the chip alone, without a buffer.
const ENABLES: u32 = 1 | 1 << 16;
const ON_CHIP: u32 = 0b011 | 0b011 << 16;
const MODES: u32 = 0b111 | 0b111 << 16;
/// MCR: the range of bus clocks, which has no effect on codes.
const CLOCK_RANGE: u32 = 0b11 << 14;
/// SR: each channel is ready, which it is at once.
const READY: u32 = 11;

const REGISTERS: Table = &[
    (CR, 0, ENABLES),
    (DHR12R[0], 0, 0xFFF),
    (DHR12R[1], 0, 0xFFF),
    (MCR, 0, ON_CHIP | CLOCK_RANGE),
];

/// The DAC.
#[derive(Clone, Debug)]
pub struct ThresholdDac(Registers);

impl Default for ThresholdDac {
    fn default() -> Self {
        Self(Registers::new(REGISTERS))
    }
}

impl ThresholdDac {
    /// The channels' voltages, as parts of the reference; zero if off.
    pub fn outputs(&self) -> [f64; 2] {
        [0, 1].map(|channel| {
            let is_on = self.0.has(CR, 1 << (16 * channel));
            let code = if is_on { self.0.get(DHR12R[channel]) } else { 0 };
            f64::from(code) / 4096.0
        })
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            DOR1 => Ok(self.0.get(DHR12R[0])),
            DOR2 => Ok(self.0.get(DHR12R[1])),
            SR => Ok(self.0.get(CR) << READY),
            _ => self.0.read(offset),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        self.0.check(offset, value, 0)?;
        if offset == CR && value != 0 && self.0.get(MCR) & MODES != ON_CHIP {
            return Err(Unmodelled::Bits(value));
        }
        self.0.set(offset, value);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_puts_its_code_out_at_once() {
        let mut dac = ThresholdDac::default();
        for (register, value) in [(MCR, ON_CHIP | 0b10 << 14), (DHR12R[0], 1024), (DHR12R[1], 512)]
        {
            dac.write(register, value).unwrap();
        }
        assert_eq!(dac.outputs(), [0.0, 0.0]);
        dac.write(CR, ENABLES).unwrap();
        assert_eq!(dac.outputs(), [0.25, 0.125]);
        assert_eq!(dac.read(SR), Ok(1 << 11 | 1 << 27));
    }

    #[test]
    fn a_channel_with_a_pin_or_a_trigger_is_not_modelled() {
        let mut dac = ThresholdDac::default();
        assert!(dac.write(CR, 1).is_err(), "with its buffer, as out of reset");
        dac.write(MCR, ON_CHIP).unwrap();
        assert!(dac.write(CR, 0b11).is_err(), "triggered");
        assert!(dac.write(0x20, 0).is_err());
    }
}
