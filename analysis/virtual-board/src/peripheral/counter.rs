//! A general-purpose timer (RM0440, 31.5; RM0090, 18.4) in the two ways that the programs use one:
//! as a clock that counts up, and as the counter of a quadrature encoder.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled, only};

const CR1: u32 = 0x00;
const SMCR: u32 = 0x08;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCMR2: u32 = 0x1C;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;
const CCR3: u32 = 0x3C;
const CCR4: u32 = 0x40;

/// CR1: counting.
const ENABLE: u32 = 1;
/// SMCR: all four edges of two channels count.
const BOTH_CHANNELS: u32 = 0b011;
/// CCMR1: each channel captures from its own input, and filters it.
const OWN_INPUTS: u32 = 0x0101;
const FILTERS: u32 = 0xF0F0;
/// CCER: both channels enabled, neither inverted.
const CHANNELS: u32 = 0x0011;
/// CCMR2 and CCER: channel 4 captures the count at the trigger that SMCR chooses, which is the first: TIM1's.
const TRIGGERED_CAPTURE: u32 = 0b11 << 8;
const CAPTURES: u32 = 1 << 12;
/// CCMR2 and CCER: channel 3 captures it at a rising edge of its own input, behind a filter.
const INDEX_CAPTURE: u32 = 0b01;
const INDEX_FILTER: u32 = 0xF0;
const CAPTURES_INDEX: u32 = 1 << 8;
/// SR: channel 3 has captured, and its capture has not been read.
const INDEX_CAPTURED: u32 = 1 << 3;

const REGISTERS: Table = &[
    (CR1, 0, ENABLE),
    (SMCR, 0, BOTH_CHANNELS),
    (SR, 0, 0),
    (CCMR1, 0, OWN_INPUTS | FILTERS),
    (CCMR2, 0, TRIGGERED_CAPTURE | INDEX_CAPTURE | INDEX_FILTER),
    (CCER, 0, CHANNELS | CAPTURES | CAPTURES_INDEX),
    (PSC, 0, 0),
    (ARR, 0, 0),
];

/// The timer.
#[derive(Clone, Debug)]
pub struct Counter {
    /// Its largest value: all bits that it has.
    mask: u32,
    registers: Registers,
    /// What channel 4 has captured.
    captured: u32,
    /// What channel 3 has.
    index: u32,
    /// What it holds, at the time when it held it.
    value: u32,
    at: u64,
}

impl Counter {
    /// A counter of so many bits, out of reset.
    pub fn new(bits: u32) -> Self {
        let (mask, mut registers) = (u32::MAX >> (32 - bits), Registers::new(REGISTERS));
        registers.set(ARR, mask);
        Self { mask, registers, captured: 0, index: 0, value: 0, at: 0 }
    }

    /// Whether it counts an encoder, as the program has set it up.
    pub fn counts_encoder(&self) -> bool {
        let has_all = |register, bits| self.registers.get(register) & bits == bits;
        let is_set_up = has_all(CCMR1, OWN_INPUTS) && has_all(CCER, CHANNELS);
        self.runs() && self.follows_encoder() && is_set_up
    }

    fn runs(&self) -> bool {
        self.registers.has(CR1, ENABLE)
    }

    fn follows_encoder(&self) -> bool {
        self.registers.get(SMCR) == BOTH_CHANNELS
    }

    /// The filters of both inputs, ICxF of CCMR1.
    pub fn filters(&self) -> [u32; 2] {
        [4, 12].map(|shift| self.registers.get(CCMR1) >> shift & 0xF)
    }

    /// Edges from an encoder: so many counts up.
    pub fn turn(&mut self, counts: i32) {
        if self.counts_encoder() {
            let modulus = i64::from(self.registers.get(ARR)) + 1;
            let sum = i64::from(self.value) + i64::from(counts);
            self.value = sum.rem_euclid(modulus) as u32;
        }
    }

    /// TIM1's trigger output rises.
    pub fn capture(&mut self) {
        if self.captures() && self.runs() {
            self.captured = self.value;
        }
    }

    fn captures(&self) -> bool {
        let mode = self.registers.get(CCMR2) & TRIGGERED_CAPTURE;
        mode == TRIGGERED_CAPTURE && self.registers.has(CCER, CAPTURES)
    }

    /// The encoder's index rises.
    pub fn index(&mut self) {
        if self.captures_index() && self.runs() {
            self.index = self.value;
            self.registers.set(SR, INDEX_CAPTURED);
        }
    }

    fn captures_index(&self) -> bool {
        self.registers.has(CCMR2, INDEX_CAPTURE) && self.registers.has(CCER, CAPTURES_INDEX)
    }

    /// The filter of the index, IC3F of CCMR2.
    pub fn index_filter(&self) -> u32 {
        self.registers.get(CCMR2) >> 4 & 0xF
    }

    /// What it holds.
    pub fn value(&self, now: u64, divider: u64) -> u32 {
        if !self.runs() || self.follows_encoder() {
            return self.value;
        }
        let [prescaler, reload] = [PSC, ARR].map(|offset| u64::from(self.registers.get(offset)));
        let counts = (now - self.at) / ((prescaler + 1) * divider);
        ((u64::from(self.value) + counts) % (reload + 1)) as u32
    }

    /// Reads.
    pub fn read(&mut self, offset: u32, now: u64, divider: u64) -> Access<u32> {
        match offset {
            CNT => Ok(self.value(now, divider)),
            // The read acknowledges.
            CCR3 if self.captures_index() => {
                self.registers.set(SR, 0);
                Ok(self.index)
            }
            CCR4 if self.captures() => Ok(self.captured),
            _ => self.registers.read(offset),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u64) -> Access<()> {
        // What it has counted so far was counted as it was set up so far.
        (self.value, self.at) = (self.value(now, divider), now);
        match offset {
            // Ones leave flags as they are.
            SR => self.registers.change(SR, !value, 0),
            // An update by the program: from zero, with the prescaler that was written.
            EGR => {
                only(value, 1)?;
                self.value = 0;
            }
            CNT => self.value = value & self.mask,
            PSC => self.registers.set(PSC, value & 0xFFFF),
            ARR => self.registers.set(ARR, value & self.mask),
            _ => {
                self.registers.check(offset, value, 0)?;
                // Channel 4 captures from no input.
                let is_own_input = !matches!(value & TRIGGERED_CAPTURE, 0 | TRIGGERED_CAPTURE);
                if offset == CCMR2 && is_own_input {
                    return Err(Unmodelled::Bits(value));
                }
                self.registers.set(offset, value);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_that_captures_nothing_is_not_read() {
        let mut counter = Counter::new(16);
        assert!(counter.read(CCR3, 0, 1).is_err());
        assert!(counter.read(CCR4, 0, 1).is_err());
        assert!(counter.write(CCMR2, 0b01 << 8, 0, 1).is_err(), "its own input");
    }
}
