//! A basic timer, TIM6 or TIM7 (RM0440, 32.4; RM0090, 20.4): counts up to its reload value, and its update
//! is an interrupt and a trigger.

use super::{Access, Unmodelled, only};

/// CR1: counting.
const ENABLE: u32 = 1;
/// CR1: only an overflow sets the flag.
const ONLY_OVERFLOW: u32 = 1 << 2;
/// CR2: the update is the trigger output.
const TRIGGER_UPDATE: u32 = 0b010 << 4;
/// The one bit of DIER, SR and EGR.
const UPDATE: u32 = 1;

/// The timer.
#[derive(Clone, Debug, Default)]
pub struct BasicTimer {
    control: u32,
    trigger: u32,
    interrupt: u32,
    flag: u32,
    prescaler: u32,
    reload: u32,
    /// The active prescaler, which takes effect at an update.
    counting: u32,
    /// The starting count; unused while it counts.
    count: u32,
    /// The time of its next overflow, while it counts.
    overflow: Option<u64>,
}

impl BasicTimer {
    /// The timer after reset.
    pub fn new() -> Self {
        Self { reload: 0xFFFF, ..Self::default() }
    }

    /// The time of its next overflow.
    pub fn due(&self) -> Option<u64> {
        self.overflow
    }

    /// Overflows if it is due; returns whether it did. `divider` is the core's clock divided by the timer's.
    pub fn advance(&mut self, now: u64, divider: u64) -> bool {
        let Some(overflow) = self.overflow.filter(|&overflow| overflow <= now) else {
            return false;
        };
        self.counting = self.prescaler;
        self.flag = UPDATE;
        self.overflow = Some(overflow + self.period(divider));
        true
    }

    /// The level of its interrupt line.
    pub fn line(&self) -> bool {
        self.flag & self.interrupt != 0
    }

    /// Whether its updates are triggers.
    pub fn triggers(&self) -> bool {
        self.trigger == TRIGGER_UPDATE
    }

    /// Whether it counts.
    pub fn runs(&self) -> bool {
        self.overflow.is_some()
    }

    /// Core clocks in its period.
    pub fn period(&self, divider: u64) -> u64 {
        (u64::from(self.counting) + 1) * (u64::from(self.reload) + 1) * divider
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00 => Ok(self.control),
            0x04 => Ok(self.trigger),
            0x0C => Ok(self.interrupt),
            0x10 => Ok(self.flag),
            0x28 => Ok(self.prescaler),
            0x2C => Ok(self.reload),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u64) -> Access<()> {
        match offset {
            0x00 => {
                only(value, ENABLE | ONLY_OVERFLOW)?;
                self.control = value;
                let on = value & ENABLE != 0;
                if on != self.runs() {
                    let passed = u64::from(self.count) * (u64::from(self.counting) + 1) * divider;
                    self.overflow = on.then(|| (now + self.period(divider)).saturating_sub(passed));
                }
            }
            0x04 => {
                only(value, TRIGGER_UPDATE)?;
                self.trigger = value;
            }
            0x0C => {
                only(value, UPDATE)?;
                self.interrupt = value;
            }
            // Bits are cleared by writing zero.
            0x10 => self.flag &= value,
            0x14 => {
                only(value, UPDATE)?;
                self.generate(now, divider);
            }
            0x24 if !self.runs() && value <= self.reload => self.count = value,
            0x28 => self.prescaler = value & 0xFFFF,
            0x2C => self.reload = value & 0xFFFF,
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }

    /// An update by the program: activates the prescaler and restarts from zero.
    fn generate(&mut self, now: u64, divider: u64) {
        self.counting = self.prescaler;
        self.count = 0;
        if self.control & ONLY_OVERFLOW == 0 {
            self.flag = UPDATE;
        }
        if self.runs() {
            self.overflow = Some(now + self.period(divider));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Registers, as the program writes them.
    const CR1: u32 = 0x00;
    const DIER: u32 = 0x0C;
    const SR: u32 = 0x10;
    const EGR: u32 = 0x14;
    const CNT: u32 = 0x24;
    const PSC: u32 = 0x28;
    const ARR: u32 = 0x2C;

    /// Prepared for a prescaler of 3 and a period of 1000, and started at 5000.
    fn started(divider: u64) -> BasicTimer {
        let mut tick_timer = BasicTimer::new();
        for (register, value) in
            [(PSC, 2), (ARR, 999), (CR1, ONLY_OVERFLOW), (EGR, 1), (DIER, 1), (CR1, ENABLE)]
        {
            tick_timer.write(register, value, 5000, divider).unwrap();
        }
        tick_timer
    }

    #[test]
    fn a_period_is_prescaler_times_reload_in_the_timer_s_own_clocks() {
        for divider in [1, 2] {
            let (mut tick_timer, period) = (started(divider), 3000 * divider);
            assert_eq!(tick_timer.due(), Some(5000 + period));
            assert!(!tick_timer.advance(5000 + period - 1, divider) && !tick_timer.line());
            // Late or not, the next one is a period behind.
            assert!(tick_timer.advance(5000 + period + 7, divider) && tick_timer.line());
            assert_eq!(tick_timer.due(), Some(5000 + 2 * period));
        }
    }

    /// As far ahead as its count is set to, and then once a period.
    #[test]
    fn a_count_that_is_set_makes_the_first_period_shorter() {
        for divider in [1, 2] {
            let mut timer = BasicTimer::new();
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
    fn its_flag_stays_until_it_is_cleared() {
        let mut tick_timer = started(1);
        assert!(tick_timer.advance(8000, 1));
        tick_timer.write(SR, UPDATE, 8001, 1).unwrap();
        assert!(tick_timer.line(), "a one leaves it");
        tick_timer.write(SR, 0, 8002, 1).unwrap();
        assert!(!tick_timer.line());
        assert_eq!(tick_timer.due(), Some(11_000));
    }

    #[test]
    fn a_new_prescaler_waits_for_an_update_and_only_an_overflow_is_one_to_the_flag() {
        let mut tick_timer = started(1);
        tick_timer.write(PSC, 0, 5001, 1).unwrap();
        assert_eq!(tick_timer.due(), Some(8000));
        assert!(tick_timer.advance(8000, 1));
        assert_eq!(tick_timer.due(), Some(9000));
        let mut tick_timer = BasicTimer::new();
        tick_timer.write(DIER, UPDATE, 0, 1).unwrap();
        tick_timer.write(EGR, UPDATE, 0, 1).unwrap();
        assert!(tick_timer.line(), "an update by the program is one, unless it says otherwise");
    }
}
