//! A general-purpose timer (RM0440, 31.5; RM0090, 18.4) in the two ways that the programs use one:
//! as a clock that counts up, and as the counter of a quadrature encoder.

use super::{Access, Unmodelled, only};

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

/// The timer.
#[derive(Clone, Debug)]
pub struct Counter {
    /// Its largest value: all bits that it has.
    mask: u32,
    control: u32,
    slave: u32,
    inputs: u32,
    channels: u32,
    capture_mode: u32,
    /// What channel 4 has captured.
    captured: u32,
    /// What channel 3 has, and SR.
    index: u32,
    status: u32,
    prescaler: u32,
    reload: u32,
    /// What it holds, at the time when it held it.
    value: u32,
    at: u64,
}

impl Counter {
    /// A counter of so many bits, out of reset.
    pub fn new(bits: u32) -> Self {
        let mask = u32::MAX >> (32 - bits);
        Self {
            mask,
            control: 0,
            slave: 0,
            inputs: 0,
            channels: 0,
            capture_mode: 0,
            captured: 0,
            index: 0,
            status: 0,
            prescaler: 0,
            reload: mask,
            value: 0,
            at: 0,
        }
    }

    /// Whether it counts an encoder, as the program has set it up.
    pub fn counts_encoder(&self) -> bool {
        self.control & ENABLE != 0
            && self.slave == BOTH_CHANNELS
            && self.inputs & OWN_INPUTS == OWN_INPUTS
            && self.channels & CHANNELS == CHANNELS
    }

    /// The filters of both inputs, ICxF of CCMR1.
    pub fn filters(&self) -> [u32; 2] {
        [self.inputs >> 4 & 0xF, self.inputs >> 12 & 0xF]
    }

    /// Edges from an encoder: so many counts up.
    pub fn turn(&mut self, counts: i32) {
        if self.counts_encoder() {
            let modulus = i64::from(self.reload) + 1;
            let sum = i64::from(self.value) + i64::from(counts);
            self.value = sum.rem_euclid(modulus) as u32;
        }
    }

    /// TIM1's trigger output rises.
    pub fn capture(&mut self) {
        if self.captures() && self.control & ENABLE != 0 {
            self.captured = self.value;
        }
    }

    fn captures(&self) -> bool {
        self.capture_mode & TRIGGERED_CAPTURE == TRIGGERED_CAPTURE && self.channels & CAPTURES != 0
    }

    /// The encoder's index rises.
    pub fn index(&mut self) {
        if self.captures_index() && self.control & ENABLE != 0 {
            self.index = self.value;
            self.status |= INDEX_CAPTURED;
        }
    }

    fn captures_index(&self) -> bool {
        self.capture_mode & INDEX_CAPTURE != 0 && self.channels & CAPTURES_INDEX != 0
    }

    /// The filter of the index, IC3F of CCMR2.
    pub fn index_filter(&self) -> u32 {
        self.capture_mode >> 4 & 0xF
    }

    /// What it holds.
    pub fn value(&self, now: u64, divider: u64) -> u32 {
        if self.control & ENABLE == 0 || self.slave == BOTH_CHANNELS {
            return self.value;
        }
        let counts = (now - self.at) / ((u64::from(self.prescaler) + 1) * divider);
        ((u64::from(self.value) + counts) % (u64::from(self.reload) + 1)) as u32
    }

    /// Reads.
    pub fn read(&mut self, offset: u32, now: u64, divider: u64) -> Access<u32> {
        match offset {
            0x00 => Ok(self.control),
            0x08 => Ok(self.slave),
            0x10 => Ok(self.status),
            0x18 => Ok(self.inputs),
            0x1C => Ok(self.capture_mode),
            0x20 => Ok(self.channels),
            0x24 => Ok(self.value(now, divider)),
            0x28 => Ok(self.prescaler),
            0x2C => Ok(self.reload),
            // The read acknowledges.
            0x3C if self.captures_index() => {
                self.status &= !INDEX_CAPTURED;
                Ok(self.index)
            }
            0x40 if self.captures() => Ok(self.captured),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u64) -> Access<()> {
        // What it has counted so far was counted as it was set up so far.
        (self.value, self.at) = (self.value(now, divider), now);
        match offset {
            0x00 => {
                only(value, ENABLE)?;
                self.control = value;
            }
            0x08 => {
                only(value, BOTH_CHANNELS)?;
                self.slave = value;
            }
            // Ones leave flags as they are.
            0x10 => self.status &= value,
            // An update by the program: from zero, with the prescaler that was written.
            0x14 => {
                only(value, 1)?;
                self.value = 0;
            }
            0x18 => {
                only(value, OWN_INPUTS | FILTERS)?;
                self.inputs = value;
            }
            0x1C => {
                only(value, TRIGGERED_CAPTURE | INDEX_CAPTURE | INDEX_FILTER)?;
                // Channel 4 captures from no input.
                if !matches!(value & TRIGGERED_CAPTURE, 0 | TRIGGERED_CAPTURE) {
                    return Err(Unmodelled::Bits(value));
                }
                self.capture_mode = value;
            }
            0x20 => {
                only(value, CHANNELS | CAPTURES | CAPTURES_INDEX)?;
                self.channels = value;
            }
            0x24 => self.value = value & self.mask,
            0x28 => self.prescaler = value & 0xFFFF,
            0x2C => self.reload = value & self.mask,
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trigger_captures_the_count() {
        let mut counter = Counter::new(16);
        for (register, value) in [
            (0x08, BOTH_CHANNELS),
            (0x18, OWN_INPUTS),
            (0x1C, TRIGGERED_CAPTURE),
            (0x20, CHANNELS | CAPTURES),
            (0x00, ENABLE),
        ] {
            counter.write(register, value, 0, 1).unwrap();
        }
        counter.turn(-3);
        assert_eq!(counter.read(0x40, 0, 1), Ok(0));
        counter.capture();
        counter.turn(1);
        assert_eq!(counter.read(0x40, 0, 1), Ok(0xFFFD));
        assert_eq!(counter.read(0x24, 0, 1), Ok(0xFFFE));
    }

    #[test]
    fn an_index_captures_the_count_until_it_is_read() {
        let mut counter = Counter::new(16);
        for (register, value) in [
            (0x08, BOTH_CHANNELS),
            (0x18, OWN_INPUTS),
            (0x1C, TRIGGERED_CAPTURE | INDEX_CAPTURE | 0x30),
            (0x20, CHANNELS | CAPTURES | CAPTURES_INDEX),
            (0x00, ENABLE),
        ] {
            counter.write(register, value, 0, 1).unwrap();
        }
        assert_eq!((counter.index_filter(), counter.read(0x10, 0, 1)), (3, Ok(0)));
        counter.turn(7);
        counter.index();
        counter.turn(1);
        assert_eq!(counter.read(0x10, 0, 1), Ok(INDEX_CAPTURED));
        assert_eq!(counter.read(0x40, 0, 1), Ok(0), "the other channel");
        assert_eq!(counter.read(0x3C, 0, 1), Ok(7));
        assert_eq!(counter.read(0x10, 0, 1), Ok(0));
        counter.index();
        counter.write(0x10, !INDEX_CAPTURED, 0, 1).unwrap();
        assert_eq!(counter.read(0x10, 0, 1), Ok(0));
    }

    #[test]
    fn a_channel_that_captures_nothing_is_not_read() {
        let mut counter = Counter::new(16);
        assert!(counter.read(0x3C, 0, 1).is_err());
        assert!(counter.read(0x40, 0, 1).is_err());
        assert!(counter.write(0x1C, 0b01 << 8, 0, 1).is_err(), "its own input");
    }
}
