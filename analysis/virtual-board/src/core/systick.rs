//! The core's own timer, SysTick (ARM DDI 0403E, B3.3): counts the core's clock down.

use crate::peripheral::Access;

/// Counter bits.
const MASK: u32 = 0x00FF_FFFF;
/// SYST_CSR: counting.
const ENABLE: u32 = 1;
/// SYST_CSR: an exception at zero.
const INTERRUPT: u32 = 1 << 1;
/// SYST_CSR: the core's clock and not the external one, which these chips divide by eight.
const CORE_CLOCK: u32 = 1 << 2;
/// SYST_CSR: zero was reached since it was last read.
const REACHED: u32 = 1 << 16;

/// The timer.
#[derive(Clone, Debug, Default)]
pub struct SysTick {
    control: u32,
    reload: u32,
    /// The next time at which the counter is zero, while it counts.
    zero: Option<u64>,
    reached: bool,
}

impl SysTick {
    /// The time of its next event.
    pub fn due(&self) -> Option<u64> {
        self.zero
    }

    /// Runs due events; returns whether it requests its exception.
    pub fn advance(&mut self, now: u64) -> bool {
        let Some(zero) = self.zero.filter(|&zero| zero <= now) else { return false };
        self.reached = true;
        self.zero = (self.reload > 0).then(|| zero + u64::from(self.reload) + 1);
        self.control & INTERRUPT != 0
    }

    /// Reads a register by its offset.
    pub fn read(&mut self, offset: u32, now: u64) -> Access<u32> {
        match offset {
            0x0 => {
                let reached = if std::mem::take(&mut self.reached) { REACHED } else { 0 };
                Ok(self.control | reached)
            }
            0x4 => Ok(self.reload),
            0x8 => Ok(self.zero.map_or(0, |zero| zero.saturating_sub(now) as u32 & MASK)),
            _ => Err(crate::peripheral::Unmodelled::Register),
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Access<()> {
        match offset {
            0x0 => {
                crate::peripheral::only(value, ENABLE | INTERRUPT | CORE_CLOCK)?;
                let was_on = self.control & ENABLE != 0;
                self.control = value;
                let on = value & ENABLE != 0;
                if on && value & CORE_CLOCK == 0 {
                    return Err(crate::peripheral::Unmodelled::Bits(CORE_CLOCK));
                }
                if on != was_on {
                    self.zero = on.then(|| now + u64::from(self.reload) + 1);
                }
            }
            0x4 => self.reload = value & MASK,
            // Any value clears the counter, which reloads at the next count.
            0x8 => {
                self.reached = false;
                if self.zero.is_some() {
                    self.zero = Some(now + u64::from(self.reload) + 1);
                }
            }
            _ => return Err(crate::peripheral::Unmodelled::Register),
        }
        Ok(())
    }
}
