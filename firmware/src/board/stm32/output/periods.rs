//! The clock that never stops, and the servo's periods that have begun by it. Belongs to what paces the servo.

use core::num::NonZeroU32;

use crate::board::stm32::wiring::CLOCK;
use crate::servo_loop::PeriodClock;

/// The clock.
#[inline(always)]
pub fn now() -> u32 {
    CLOCK.cnt().read()
}

/// Keeps count of the periods.
#[derive(Debug)]
pub struct Periods {
    clock: PeriodClock,
    /// Seconds in a period, as it is paced.
    seconds: f64,
}

impl Periods {
    /// Periods of this many clock counts and seconds, each in time within so many counts. Prepares the clock,
    /// which stands.
    pub fn new(counts: NonZeroU32, seconds: f64, in_time: u32) -> Self {
        CLOCK.psc().write_value(0);
        CLOCK.arr().write_value(u32::MAX);
        CLOCK.egr().write(|w| w.set_ug(true));
        Self { clock: PeriodClock::new(counts, in_time), seconds }
    }

    /// Starts the clock and then the timers that pace, so that no period begins before the clock's.
    pub fn start(&mut self, timers: impl FnOnce()) {
        cortex_m::interrupt::free(|_| {
            CLOCK.cnt().write_value(0);
            CLOCK.cr1().modify(|w| w.set_cen(true));
            timers();
        });
    }

    /// The periods that had begun at this time, since this was last asked: see
    /// [`PeriodClock::begun_by`].
    #[inline(always)]
    pub fn begun_by(&mut self, time: u32) -> u32 {
        self.clock.begun_by(time)
    }

    /// Clock counts in a period.
    pub fn counts(&self) -> u32 {
        self.clock.counts()
    }

    /// Seconds in a period, as it is paced.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Clock counts since the present period began.
    #[inline(always)]
    pub fn elapsed(&self) -> u32 {
        self.clock.elapsed_at(now())
    }
}
