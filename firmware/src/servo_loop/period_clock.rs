//! Counts the servo's periods by a free-running clock. The timer that paces the servo owns it.

use core::hint::cold_path;
use core::num::NonZeroU32;

use super::BEGAN_LATE;

/// Counts the periods by a clock that wraps at 32 bits. The first period began at zero of the clock; its tick
/// is due one period later.
///
/// ```
/// use core::num::NonZeroU32;
/// use haptic_servo::servo_loop::{BEGAN_LATE, PeriodClock};
///
/// let mut periods = PeriodClock::new(NonZeroU32::new(1000).unwrap(), 10);
/// assert_eq!(periods.begun_by(1009), 1); // in time: 9 counts after its beginning
/// assert_eq!(periods.elapsed_at(1300), 300);
/// assert_eq!(periods.begun_by(2010), BEGAN_LATE);
/// assert_eq!(periods.begun_by(5009), 3); // two ticks were missed
/// assert_eq!(periods.begun_by(6000), 1);
/// ```
#[derive(Clone, Debug)]
pub struct PeriodClock {
    /// Clock counts in a period.
    counts: NonZeroU32,
    /// Clock counts after the beginning of a period within which its tick is in time.
    in_time: u32,
    /// The clock when the present period began.
    began: u32,
}

impl PeriodClock {
    /// Periods of `counts` clock counts; a tick is in time within the first `in_time` of them: the counts of
    /// [`READ_WITHIN`](super::READ_WITHIN) seconds on a board whose certificate must hold.
    pub const fn new(counts: NonZeroU32, in_time: u32) -> Self {
        Self { counts, in_time, began: 0 }
    }

    /// The number of periods that began between the last call and this time of the clock: the result of
    /// [`Hardware::periods_since_last`](super::Hardware::periods_since_last).
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
        self.began = next.wrapping_add(missed.wrapping_mul(self.counts.get()));
        if missed == 0 { BEGAN_LATE } else { missed + 1 }
    }

    /// Clock counts in a period.
    pub const fn counts(&self) -> u32 {
        self.counts.get()
    }

    /// Clock counts since the present period began: the result of
    /// [`Hardware::time_in_period`](super::Hardware::time_in_period).
    #[inline(always)]
    pub const fn elapsed_at(&self, time: u32) -> u32 {
        time.wrapping_sub(self.began)
    }
}
