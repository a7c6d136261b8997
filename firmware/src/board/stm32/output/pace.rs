//! The pace of the servo: its periods, counted by a free-running clock. The servo's interrupt owns it.

use core::num::NonZeroU32;

use crate::board::stm32::wiring::CLOCK;
use crate::servo_loop::PeriodClock;

/// The clock.
#[inline(always)]
pub fn now() -> u32 {
    CLOCK.cnt().read()
}

/// Counts the periods.
#[derive(Debug)]
pub struct Pace {
    clock: PeriodClock,
    /// The paced period in s.
    seconds: f64,
}

impl Pace {
    /// Periods of `counts` clock counts and `seconds`; a tick is in time within `in_time` counts. Prepares
    /// the clock, which does not run yet.
    pub fn new(counts: NonZeroU32, seconds: f64, in_time: u32) -> Self {
        CLOCK.psc().write_value(0);
        CLOCK.arr().write_value(u32::MAX);
        CLOCK.egr().write(|w| w.set_ug(true));
        Self { clock: PeriodClock::new(counts, in_time), seconds }
    }

    /// Starts the clock and then the pacing timers, so that no period begins before the clock's.
    pub fn start(&mut self, timers: impl FnOnce()) {
        cortex_m::interrupt::free(|_| {
            CLOCK.cnt().write_value(0);
            CLOCK.cr1().modify(|w| w.set_cen(true));
            timers();
        });
    }

    /// The number of periods that began between the last call and this time: see [`PeriodClock::begun_by`].
    #[inline(always)]
    pub fn begun_by(&mut self, time: u32) -> u32 {
        self.clock.begun_by(time)
    }

    /// Counts of a period within which a tick is in time whose count hardware has taken at the period's beginning.
    #[cfg(feature = "magnetic")]
    pub const fn in_time_of_hardware(period: u32) -> u32 {
        period / 2
    }

    /// Lets the next tick count as late, or none.
    #[cfg(feature = "magnetic")]
    pub fn doubt(&mut self, next: bool) {
        let in_time = if next { 0 } else { Self::in_time_of_hardware(self.counts()) };
        self.clock.set_in_time(in_time);
    }

    /// Clock counts in a period.
    pub fn counts(&self) -> u32 {
        self.clock.counts()
    }

    /// The paced period in s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Clock counts since the present period began.
    #[inline(always)]
    pub fn elapsed(&self) -> u32 {
        self.clock.elapsed_at(now())
    }
}
