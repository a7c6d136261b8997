//! The servo's hardware on the emulated board.

use super::tick_timer::{Period, TickTimer};
use super::{lines, lockstep};
use crate::board::fault_memory;
use crate::boot::Startup;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::FaultRecord;
use crate::reset::ResetCause;
use crate::servo_loop::Hardware;

/// The data of the servo's interrupt.
pub struct Registers {
    pace: TickTimer,
    period: Period,
}

impl Registers {
    /// The hardware of a board with this period.
    pub fn new(period: Period) -> Self {
        Self { pace: TickTimer::new(period), period }
    }

    /// Call it just before the timer starts.
    pub fn start(&mut self) {
        self.pace = TickTimer::new(self.period);
    }

    /// Skips this number of periods without a tick.
    pub fn lose(&mut self, missed: u32) {
        self.pace.lose(missed);
    }
}

impl Hardware for Registers {
    #[inline(always)]
    fn count(&mut self) -> RawCount {
        lines::count()
    }

    #[inline(always)]
    fn write(&mut self, code: DacCode) {
        lines::write(code);
    }

    #[inline(always)]
    fn amplifier(&mut self, on: bool) {
        lines::amplifier(on);
    }

    #[inline(always)]
    fn periods_since_last(&mut self) -> u32 {
        self.pace.periods_since_last()
    }

    #[inline(always)]
    fn time_in_period(&mut self) -> u32 {
        self.pace.time_in_period()
    }

    /// The emulator has no watchdog.
    #[inline(always)]
    fn feed_watchdog(&mut self) {}

    fn store_fault(&mut self, record: &[u32; FaultRecord::WORDS]) {
        fault_memory::store(record);
    }
}

impl Startup for Registers {
    fn zero_encoder(&mut self) {
        lockstep::zero_count();
    }

    /// The emulator has no watchdog.
    fn start_watchdog(&mut self) {}

    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS] {
        fault_memory::stored()
    }

    /// Only its own program resets the emulated board.
    fn reset_cause(&mut self) -> ResetCause {
        if fault_memory::power_stayed() { ResetCause::Software } else { ResetCause::PowerOn }
    }

    fn period(&self) -> u32 {
        self.period.clock_counts()
    }
}
