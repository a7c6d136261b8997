//! When a tick is due with the bridge: its current interrupt pends the servo's at every so many updates
//! of TIM1, and takes count and time down at the beginning of each servo period.

use core::hint::cold_path;
use core::num::NonZeroU32;
use core::sync::atomic::{AtomicU32, Ordering};

use super::pwm;
use crate::board::stm32::quadrature::Counter;
use crate::board::stm32::wiring::{CLOCK, ENCODER};
use crate::encoder::RawCount;
use crate::servo_loop::{BEGAN_LATE, READ_WITHIN};

/// The clock when the count of the present period was read, and that count.
static TIME: AtomicU32 = AtomicU32::new(0);
static COUNT: AtomicU32 = AtomicU32::new(0);

/// Takes the count of a period down. For the current interrupt, as its first deed.
#[inline(always)]
pub fn sample() {
    COUNT.store(u32::from(ENCODER.cnt().read().cnt()), Ordering::Relaxed);
    TIME.store(CLOCK.cnt().read(), Ordering::Relaxed);
}

/// Keeps count of the periods. Belongs to the servo's interrupt.
#[derive(Debug)]
pub struct Pace {
    /// Clock counts in a period.
    period: NonZeroU32,
    /// Seconds in a period.
    seconds: f64,
    /// Clock counts after its beginning in which a count has to be read.
    in_time: u32,
    /// The clock when the present period began.
    began: u32,
}

impl Pace {
    /// A period of this many clock counts, of so many a second.
    pub fn new(period: NonZeroU32, clock: f64) -> Self {
        CLOCK.psc().write_value(0);
        CLOCK.arr().write_value(u32::MAX);
        CLOCK.egr().write(|w| w.set_ug(true));
        let seconds = f64::from(period.get()) / clock;
        // The cast gives the nearest of what does not fit.
        Self { period, seconds, in_time: (clock * READ_WITHIN) as u32, began: 0 }
    }

    /// Starts the clock and then TIM1, so that no period begins before the clock's.
    pub fn start(&mut self) {
        cortex_m::interrupt::free(|_| {
            CLOCK.cnt().write_value(0);
            CLOCK.cr1().modify(|w| w.set_cen(true));
            pwm::start();
        });
    }

    /// The encoder's count at the beginning of the period.
    #[inline(always)]
    pub fn count(&self) -> RawCount {
        RawCount::from(COUNT.load(Ordering::Relaxed) as u16)
    }

    /// The periods that have begun since the last time: see
    /// [`Hardware::periods_since_last`](crate::servo_loop::Hardware::periods_since_last). Late is a count
    /// that was read late, not a tick that came behind the current loop's interrupt.
    #[inline(always)]
    pub fn periods_since_last(&mut self) -> u32 {
        let next = self.began.wrapping_add(self.period.get());
        let late = TIME.load(Ordering::Relaxed).wrapping_sub(next);
        if late < self.in_time {
            self.began = next;
            return 1;
        }
        cold_path();
        let missed = late / self.period;
        self.began = next.wrapping_add(missed * self.period.get());
        if missed == 0 { BEGAN_LATE } else { missed + 1 }
    }

    /// Clock counts in a period.
    pub fn period(&self) -> u32 {
        self.period.get()
    }

    /// Seconds in a period, as it is paced.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Clock counts since the present period began.
    #[inline(always)]
    pub fn time_in_period(&self) -> u32 {
        CLOCK.cnt().read().wrapping_sub(self.began)
    }
}
