//! The clock that never stops, and the servo's periods that have begun by it. Belongs to what paces the servo.

use core::hint::cold_path;
use core::num::NonZeroU32;

use crate::board::stm32::wiring::CLOCK;
use crate::servo_loop::BEGAN_LATE;

/// The clock.
#[inline(always)]
pub fn now() -> u32 {
    CLOCK.cnt().read()
}

/// Keeps count of the periods.
#[derive(Debug)]
pub struct Periods {
    /// Clock counts in a period.
    counts: NonZeroU32,
    /// Seconds in a period, as it is paced.
    seconds: f64,
    /// Clock counts after its beginning in which a period counts as in time.
    in_time: u32,
    /// The clock when the present period began.
    began: u32,
}

impl Periods {
    /// Periods of this many clock counts and seconds, each in time within so many counts. Prepares the clock,
    /// which stands.
    pub fn new(counts: NonZeroU32, seconds: f64, in_time: u32) -> Self {
        CLOCK.psc().write_value(0);
        CLOCK.arr().write_value(u32::MAX);
        CLOCK.egr().write(|w| w.set_ug(true));
        Self { counts, seconds, in_time, began: 0 }
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
    /// [`Hardware::periods_since_last`](crate::servo_loop::Hardware::periods_since_last).
    #[inline(always)]
    pub fn begun_by(&mut self, time: u32) -> u32 {
        let next = self.began.wrapping_add(self.counts.get());
        let late = time.wrapping_sub(next);
        if late < self.in_time {
            self.began = next;
            return 1;
        }
        cold_path();
        let missed = late / self.counts;
        self.began = next.wrapping_add(missed * self.counts.get());
        if missed == 0 { BEGAN_LATE } else { missed + 1 }
    }

    /// Clock counts in a period.
    pub fn counts(&self) -> u32 {
        self.counts.get()
    }

    /// Seconds in a period, as it is paced.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Clock counts since the present period began.
    #[inline(always)]
    pub fn elapsed(&self) -> u32 {
        now().wrapping_sub(self.began)
    }
}
