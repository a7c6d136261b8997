//! The board as the servo sees it.

use super::pace::{Pace, Period};
use super::{lines, lockstep};
use crate::board::retained;
use crate::boot::Startup;
use crate::cycle::Hardware;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::Retained;
use crate::reset::ResetCause;

/// What belongs to the servo's interrupt.
pub struct Registers {
    pace: Pace,
    period: Period,
}

impl Registers {
    /// Those of a board that is paced so.
    pub fn new(period: Period) -> Self {
        Self { pace: Pace::new(period), period }
    }

    /// The pacing is about to begin.
    pub fn start(&mut self) {
        self.pace = Pace::new(self.period);
    }

    /// So many periods have passed without a tick.
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
    fn passed(&mut self) -> u32 {
        self.pace.passed()
    }

    #[inline(always)]
    fn elapsed(&mut self) -> u32 {
        self.pace.elapsed()
    }

    /// The emulator has no watchdog.
    #[inline(always)]
    fn feed(&mut self) {}

    fn keep(&mut self, record: &[u32; Retained::WORDS]) {
        retained::keep(record);
    }
}

impl Startup for Registers {
    fn zero(&mut self) {
        lockstep::zero();
    }

    /// The emulator has no watchdog.
    fn guard(&mut self) {}

    fn kept(&mut self) -> [u32; Retained::WORDS] {
        retained::kept()
    }

    /// Nothing but its own program resets the emulated board.
    fn reset_cause(&mut self) -> ResetCause {
        if retained::power_stayed() { ResetCause::Software } else { ResetCause::PowerOn }
    }

    fn period(&self) -> u32 {
        self.period.clock_counts()
    }
}
