//! The comparators COMP1 to COMP4 (RM0440, 24.5), each between the pin at its first input and a channel of
//! DAC3.

use super::{Access, Unmodelled, only};

/// CSR.
const ENABLE: u32 = 1;
const REFERENCE: u32 = 0b111 << 4;
/// A channel of DAC3: of channel 1 for COMP1 and COMP3, of channel 2 for COMP2 and COMP4.
const DAC3: u32 = 0b100 << 4;
const INVERTED: u32 = 1 << 15;
const HYSTERESIS: u32 = 0b111 << 16;
const VALUE: u32 = 1 << 30;
const LOCKED: u32 = 1 << 31;
/// Volts of a step of the hysteresis.
const HYSTERESIS_STEP: f64 = 9e-3;

/// A voltage at each comparator's pin; none where nothing is wired to it.
pub type Inputs = [Option<f64>; 4];

/// The comparators.
#[derive(Clone, Copy, Debug, Default)]
pub struct Comparators {
    controls: [u32; 4],
    /// Whether the pin is above the reference.
    above: [bool; 4],
}

impl Comparators {
    /// Whether any is on.
    pub fn any_is_on(&self) -> bool {
        self.controls.iter().any(|control| control & ENABLE != 0)
    }

    /// Which are on.
    pub fn are_on(&self) -> [bool; 4] {
        self.controls.map(|control| control & ENABLE != 0)
    }

    /// Compares the voltages at the pins with the two channels' of DAC3.
    pub fn compare(&mut self, inputs: Inputs, references: [f64; 2]) {
        for (number, input) in inputs.into_iter().enumerate() {
            let control = self.controls[number];
            let reference = references[number % 2];
            let steps = f64::from((control & HYSTERESIS) >> 16);
            let falls = reference - steps * HYSTERESIS_STEP;
            let level = if self.above[number] { falls } else { reference };
            self.above[number] = control & ENABLE != 0 && input.is_some_and(|volts| volts > level);
        }
    }

    /// Their outputs; low if off.
    pub fn outputs(&self) -> [bool; 4] {
        std::array::from_fn(|number| {
            let control = self.controls[number];
            let is_inverted = control & INVERTED != 0;
            control & ENABLE != 0 && self.above[number] ^ is_inverted
        })
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        let number = number_of(offset)?;
        let value = if self.outputs()[number] { VALUE } else { 0 };
        Ok(self.controls[number] | value)
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let number = number_of(offset)?;
        let value = value & !VALUE;
        only(value, ENABLE | REFERENCE | INVERTED | HYSTERESIS | LOCKED)?;
        if value & ENABLE != 0 && value & REFERENCE != DAC3 {
            return Err(Unmodelled::Bits(value & (ENABLE | REFERENCE)));
        }
        if self.controls[number] & LOCKED == 0 {
            self.controls[number] = value;
        }
        Ok(())
    }
}

fn number_of(offset: u32) -> Access<usize> {
    match offset {
        0x00..=0x0C => Ok(offset as usize / 4),
        _ => Err(Unmodelled::Register),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(control: u32, volts: &[f64]) -> Vec<bool> {
        let mut comparators = Comparators::default();
        comparators.write(0x04, control).unwrap();
        let outputs = volts.iter().map(|&volts| {
            comparators.compare([None, Some(volts), None, None], [9.0, 0.5]);
            let output = comparators.outputs()[1];
            assert_eq!(comparators.read(0x04).unwrap() & VALUE != 0, output);
            output
        });
        outputs.collect()
    }

    #[test]
    fn a_comparator_compares_its_pin_with_its_channel() {
        assert_eq!(compared(ENABLE | DAC3, &[0.49, 0.51, 0.499]), [false, true, false]);
        assert_eq!(compared(ENABLE | DAC3 | INVERTED, &[0.49, 0.51]), [true, false]);
        assert_eq!(compared(DAC3, &[0.51]), [false], "it is off");
    }

    #[test]
    fn hysteresis_is_below_the_reference() {
        let control = ENABLE | DAC3 | 2 << 16;
        assert_eq!(compared(control, &[0.499, 0.501, 0.483, 0.481]), [false, true, true, false]);
    }

    #[test]
    fn a_locked_one_stays_as_it_is() {
        let mut comparators = Comparators::default();
        comparators.write(0x0C, ENABLE | DAC3 | LOCKED).unwrap();
        comparators.write(0x0C, 0).unwrap();
        assert_eq!(comparators.are_on(), [false, false, false, true]);
    }

    #[test]
    fn what_is_not_modelled_is_refused() {
        let mut comparators = Comparators::default();
        for (register, value) in
            [(0x00, ENABLE), (0x00, 1 << 8), (0x04, 1 << 19), (0x10, ENABLE | DAC3)]
        {
            assert!(comparators.write(register, value).is_err(), "{register:#x}: {value:#x}");
        }
    }
}
