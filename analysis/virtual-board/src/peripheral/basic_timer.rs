//! A basic timer, TIM6 or TIM7 (RM0440, 32.4; RM0090, 20.4): counts up to its reload value, and its update
//! is an interrupt and a trigger.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled, only};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const DIER: u32 = 0x0C;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;

/// CR1: counting.
const ENABLE: u32 = 1;
/// CR1: only an overflow sets the flag.
const ONLY_OVERFLOW: u32 = 1 << 2;
/// CR2: the update is the trigger output.
const TRIGGER_UPDATE: u32 = 0b010 << 4;
/// The bit of an update in DIER, SR and EGR.
const UPDATE: u32 = 1;
/// DIER: the update is a request for the DMA.
const REQUESTS: u32 = 1 << 8;

const REGISTERS: Table = &[
    (CR1, 0, ENABLE | ONLY_OVERFLOW),
    (CR2, 0, TRIGGER_UPDATE),
    (DIER, 0, UPDATE | REQUESTS),
    (SR, 0, 0),
    (PSC, 0, 0),
    (ARR, 0xFFFF, 0),
];

/// The timer.
#[derive(Clone, Debug)]
pub struct BasicTimer {
    registers: Registers,
    /// The active prescaler, which takes effect at an update.
    counting: u32,
    /// The starting count; unused while it counts.
    count: u32,
    /// The time of its next overflow, while it counts.
    overflow: Option<u64>,
}

impl Default for BasicTimer {
    /// The timer after reset.
    fn default() -> Self {
        Self { registers: Registers::new(REGISTERS), counting: 0, count: 0, overflow: None }
    }
}

impl BasicTimer {
    /// The time of its next overflow.
    pub fn due(&self) -> Option<u64> {
        self.overflow
    }

    /// Overflows if it is due; returns whether it did. `divider` is the core's clock divided by the timer's.
    pub fn advance(&mut self, now: u64, divider: u64) -> bool {
        let Some(overflow) = self.overflow.filter(|&overflow| overflow <= now) else {
            return false;
        };
        self.counting = self.registers.get(PSC);
        self.registers.set(SR, UPDATE);
        self.overflow = Some(overflow + self.period(divider));
        true
    }

    /// The level of its interrupt line.
    pub fn line(&self) -> bool {
        self.registers.has(SR, self.registers.get(DIER) & UPDATE)
    }

    /// Whether its updates are requests for the DMA.
    pub fn requests(&self) -> bool {
        self.registers.has(DIER, REQUESTS)
    }

    /// Whether its updates are triggers.
    pub fn triggers(&self) -> bool {
        self.registers.get(CR2) == TRIGGER_UPDATE
    }

    /// Whether it counts.
    pub fn runs(&self) -> bool {
        self.overflow.is_some()
    }

    /// Core clocks in its period.
    pub fn period(&self, divider: u64) -> u64 {
        (u64::from(self.counting) + 1) * (u64::from(self.registers.get(ARR)) + 1) * divider
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        self.registers.read(offset)
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u64) -> Access<()> {
        match offset {
            // Bits are cleared by writing zero.
            SR => self.registers.change(SR, !value, 0),
            EGR => {
                only(value, UPDATE)?;
                self.generate(now, divider);
            }
            CNT if !self.runs() && value <= self.registers.get(ARR) => self.count = value,
            CNT => return Err(Unmodelled::Register),
            PSC | ARR => self.registers.set(offset, value & 0xFFFF),
            _ => self.registers.write(offset, value)?,
        }
        let on = self.registers.has(CR1, ENABLE);
        if on != self.runs() {
            let passed = u64::from(self.count) * (u64::from(self.counting) + 1) * divider;
            self.overflow = on.then(|| (now + self.period(divider)).saturating_sub(passed));
        }
        Ok(())
    }

    /// An update by the program: activates the prescaler and restarts from zero.
    fn generate(&mut self, now: u64, divider: u64) {
        self.counting = self.registers.get(PSC);
        self.count = 0;
        if !self.registers.has(CR1, ONLY_OVERFLOW) {
            self.registers.set(SR, UPDATE);
        }
        if self.runs() {
            self.overflow = Some(now + self.period(divider));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Prepared for a prescaler of 3 and a period of 1000, and started at 5000.
    fn started(divider: u64) -> BasicTimer {
        let mut tick_timer = BasicTimer::default();
        for (register, value) in
            [(PSC, 2), (ARR, 999), (CR1, ONLY_OVERFLOW), (EGR, 1), (DIER, 1), (CR1, ENABLE)]
        {
            tick_timer.write(register, value, 5000, divider).unwrap();
        }
        tick_timer
    }

    /// As far ahead as its count is set to, and then once a period.
    #[test]
    fn a_count_that_is_set_makes_the_first_period_shorter() {
        for divider in [1, 2] {
            let mut timer = BasicTimer::default();
            for (register, value) in [(PSC, 2), (ARR, 999), (CR1, ONLY_OVERFLOW), (EGR, 1)] {
                timer.write(register, value, 0, divider).unwrap();
            }
            assert!(timer.write(CNT, 1000, 0, divider).is_err());
            timer.write(CNT, 990, 0, divider).unwrap();
            timer.write(CR1, ENABLE, 5000, divider).unwrap();
            assert_eq!(timer.due(), Some(5000 + 30 * divider));
            assert!(timer.advance(5000 + 30 * divider, divider));
            assert_eq!(timer.due(), Some(5000 + 3030 * divider));
            assert!(timer.write(CNT, 0, 6000, divider).is_err(), "while it counts");
        }
    }

    #[test]
    fn a_new_prescaler_waits_for_an_update_and_only_an_overflow_is_one_to_the_flag() {
        let mut tick_timer = started(1);
        tick_timer.write(PSC, 0, 5001, 1).unwrap();
        assert_eq!(tick_timer.due(), Some(8000));
        assert!(tick_timer.advance(8000, 1));
        assert_eq!(tick_timer.due(), Some(9000));
        let mut tick_timer = BasicTimer::default();
        tick_timer.write(DIER, UPDATE, 0, 1).unwrap();
        tick_timer.write(EGR, UPDATE, 0, 1).unwrap();
        assert!(tick_timer.line(), "an update by the program is one, unless it says otherwise");
    }
}
