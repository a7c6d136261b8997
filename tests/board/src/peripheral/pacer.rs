//! A basic timer, TIM6 (RM0440, 32.4; RM0090, 20.4): counts up to its reload value, and its update
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
pub struct Pacer {
    control: u32,
    trigger: u32,
    interrupt: u32,
    flag: u32,
    prescaler: u32,
    reload: u32,
    /// The prescaler that it counts with: taken over at an update.
    counting: u32,
    /// When it next overflows, while it counts.
    overflow: Option<u64>,
}

impl Pacer {
    /// Out of reset.
    pub fn new() -> Self {
        Self { reload: 0xFFFF, ..Self::default() }
    }

    /// When it next overflows.
    pub fn due(&self) -> Option<u64> {
        self.overflow
    }

    /// Overflows where that is due; whether it did. `divider` is the core's clock by the timer's.
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

    /// Whether others are triggered by its updates.
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

    /// Shifts the next overflow: a clock source that stops for a while.
    pub fn delay(&mut self, clocks: u64) {
        self.overflow = self.overflow.map(|overflow| overflow + clocks);
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
                    self.overflow = on.then(|| now + self.period(divider));
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
            0x28 => self.prescaler = value & 0xFFFF,
            0x2C => self.reload = value & 0xFFFF,
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }

    /// An update by the program: takes the prescaler over and starts from zero.
    fn generate(&mut self, now: u64, divider: u64) {
        self.counting = self.prescaler;
        if self.control & ONLY_OVERFLOW == 0 {
            self.flag = UPDATE;
        }
        if self.runs() {
            self.overflow = Some(now + self.period(divider));
        }
    }
}
