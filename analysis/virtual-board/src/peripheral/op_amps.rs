//! The operational amplifiers OPAMP1 to OPAMP3 (RM0440, 25.5), with a gain of 16 above a bias at their
//! inverting input's pin.

use super::{Access, Unmodelled, only};

/// CSR.
const ENABLE: u32 = 1;
const INPUT: u32 = 0b11 << 2;
const FEEDBACK: u32 = 0b11 << 5;
const HIGH_SPEED: u32 = 1 << 7;
const GAIN: u32 = 0x1F << 14;
const LOCKED: u32 = 1 << 31;
/// The gain's resistors between output and inverting input, whose foot is at the pin.
const RESISTORS: u32 = 0b10 << 5;
const GAIN_16_BIASED: u32 = 0b01011 << 14;

/// The amplifiers.
#[derive(Clone, Copy, Debug, Default)]
pub struct OpAmps {
    controls: [u32; 3],
}

impl OpAmps {
    /// Whether one is on, in the one way that is modelled.
    pub fn is_on(&self, number: usize) -> bool {
        self.controls[number] & ENABLE != 0
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00..=0x08 => Ok(self.controls[offset as usize / 4]),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let control = match offset {
            0x00..=0x08 => &mut self.controls[offset as usize / 4],
            _ => return Err(Unmodelled::Register),
        };
        only(value, ENABLE | FEEDBACK | HIGH_SPEED | GAIN | LOCKED)?;
        let chosen = value & (INPUT | FEEDBACK | GAIN);
        if value & ENABLE != 0 && chosen != RESISTORS | GAIN_16_BIASED {
            return Err(Unmodelled::Bits(chosen | ENABLE));
        }
        if *control & LOCKED == 0 {
            *control = value;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_amplifier_is_on_with_its_gain_of_16_only() {
        let mut op_amps = OpAmps::default();
        let control = ENABLE | HIGH_SPEED | RESISTORS | GAIN_16_BIASED;
        op_amps.write(0x04, control).unwrap();
        assert_eq!([0, 1, 2].map(|number| op_amps.is_on(number)), [false, true, false]);
        assert_eq!(op_amps.read(0x04), Ok(control));
        for value in [ENABLE, ENABLE | RESISTORS, control | 1 << 8, control | 0b01 << 2] {
            assert!(op_amps.write(0x00, value).is_err(), "{value:#x}");
        }
        assert!(op_amps.write(0x0C, 0).is_err());
    }
}
