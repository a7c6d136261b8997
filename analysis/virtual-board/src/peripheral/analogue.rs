//! The analogue units of a power stage that only keep what the program writes: the comparators COMP1 to COMP4
//! (RM0440, 24.5), the amplifiers OPAMP1 to OPAMP3 (25.5), DAC3 (22.7), whose two channels have no pin and are the
//! comparators' thresholds, and the clock that both converters share (21.4).

use super::Access;
use super::registers::{Registers, Table};
use crate::chip::Stage;

/// COMPx_CSR: on, against a channel of DAC3: the first for COMP1 and COMP3, the second for COMP2 and COMP4.
const COMPARES: u32 = 0b100 << 4 | 1;
const VALUE: u32 = 1 << 30;
const COMPARATORS: Table =
    &[(0x0, 0, COMPARES), (0x4, 0, COMPARES), (0x8, 0, COMPARES), (0xC, 0, COMPARES)];

/// OPAMPx_CSR: on, with a gain of 16 by resistors whose foot is at the inverting input's pin; and fast.
const AMPLIFIES: u32 = 0b01011 << 14 | 0b10 << 5 | 1;
const HIGH_SPEED: u32 = 1 << 7;
const OP_AMP: u32 = AMPLIFIES | HIGH_SPEED;
const OP_AMPS: Table = &[(0x0, 0, OP_AMP), (0x4, 0, OP_AMP), (0x8, 0, OP_AMP)];

/// DAC3: CR with both channels, their codes, and MCR: on the chip alone, without a buffer; and the range of bus
/// clocks, which has no effect on codes.
const CR: u32 = 0x00;
const DHR12R: [u32; 2] = [0x08, 0x14];
const MCR: u32 = 0x3C;
const ON_CHIP: [u32; 2] = [0b011, 0b011 << 16];
const THRESHOLDS: Table = &[
    (CR, 0, 1 | 1 << 16),
    (DHR12R[0], 0, 0xFFF),
    (DHR12R[1], 0, 0xFFF),
    (MCR, 0, ON_CHIP[0] | ON_CHIP[1] | 0b11 << 14),
];

/// ADC12_CCR: the bus's clock, divided.
const CCR: u32 = 0x08;
const ADC_CLOCK: Table = &[(CCR, 0, 0b11 << 16)];

/// The units.
#[derive(Clone, Debug)]
pub struct Analogue {
    comparators: Registers,
    op_amps: Registers,
    thresholds: Registers,
    adc_clock: Registers,
}

impl Default for Analogue {
    fn default() -> Self {
        Self {
            comparators: Registers::new(COMPARATORS),
            op_amps: Registers::new(OP_AMPS),
            thresholds: Registers::new(THRESHOLDS),
            adc_clock: Registers::new(ADC_CLOCK),
        }
    }
}

impl Analogue {
    fn unit(&mut self, unit: Stage) -> &mut Registers {
        match unit {
            Stage::Comparators => &mut self.comparators,
            Stage::OpAmps => &mut self.op_amps,
            Stage::ThresholdDac => &mut self.thresholds,
            _ => &mut self.adc_clock,
        }
    }

    /// Reads; of a comparator with its output.
    pub fn read(&mut self, unit: Stage, offset: u32, outputs: [bool; 4]) -> Access<u32> {
        let value = self.unit(unit).read(offset)?;
        let is_high = unit == Stage::Comparators && outputs[offset as usize / 4];
        Ok(if is_high { value | VALUE } else { value })
    }

    /// Writes.
    pub fn write(&mut self, unit: Stage, offset: u32, value: u32) -> Access<()> {
        self.unit(unit).write(offset, value)
    }

    /// A unit as after reset.
    pub fn reset(&mut self, unit: Stage) {
        *self.unit(unit) = Self::default().unit(unit).clone();
    }

    /// Outputs of the comparators for the voltages at their pins, as parts of the reference; low where a comparator
    /// is off, or nothing is wired to its pin.
    pub fn compare(&self, pins: [Option<f64>; 4]) -> [bool; 4] {
        std::array::from_fn(|number| {
            let is_on = self.comparators.has_all(4 * number as u32, COMPARES);
            is_on && pins[number].is_some_and(|pin| pin > self.threshold(number % 2))
        })
    }

    /// Whether any comparator is on.
    pub fn compares(&self) -> bool {
        (0..4).any(|number| self.comparators.has_all(4 * number, COMPARES))
    }

    /// A threshold as a part of the reference; zero if its channel is off.
    fn threshold(&self, channel: usize) -> f64 {
        let is_on = self.thresholds.has(CR, 1 << (16 * channel))
            && self.thresholds.has_all(MCR, ON_CHIP[channel]);
        f64::from(if is_on { self.thresholds.get(DHR12R[channel]) } else { 0 }) / 4096.0
    }

    /// Whether an amplifier is on, in the one way that is modelled.
    pub fn amplifies(&self, number: usize) -> bool {
        self.op_amps.has_all(4 * number as u32, AMPLIFIES)
    }

    /// Core clocks per clock of the converters; `None` if the clock is not the bus's.
    pub fn adc_divider(&self) -> Option<u64> {
        match self.adc_clock.get(CCR) >> 16 {
            0 => None,
            mode => Some(1 << (mode - 1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparator_compares_its_pin_with_its_channel() {
        let mut analogue = Analogue::default();
        let mut write = |unit, offset, value| analogue.write(unit, offset, value).unwrap();
        for (offset, value) in [(MCR, ON_CHIP[1]), (DHR12R[1], 2048), (CR, 1 << 16)] {
            write(Stage::ThresholdDac, offset, value);
        }
        write(Stage::Comparators, 0x4, COMPARES);
        for (pin, is_high) in [(0.49, false), (0.51, true)] {
            let outputs = analogue.compare([Some(pin); 4]);
            assert_eq!(outputs, [false, is_high, false, false]);
            let read = analogue.read(Stage::Comparators, 0x4, outputs).unwrap();
            assert_eq!(read & VALUE != 0, is_high);
        }
    }

    #[test]
    fn what_is_not_modelled_is_refused() {
        let mut analogue = Analogue::default();
        for (unit, offset, value) in [
            (Stage::Comparators, 0x0, 1 << 8),
            (Stage::Comparators, 0x10, COMPARES),
            (Stage::OpAmps, 0x0, OP_AMP | 1 << 8),
            (Stage::OpAmps, 0xC, 0),
            (Stage::ThresholdDac, CR, 0b11),
            (Stage::AdcCommon, CCR, 1 << 18),
        ] {
            assert!(analogue.write(unit, offset, value).is_err(), "{unit:?}, {offset:#x}");
        }
    }
}
