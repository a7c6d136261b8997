//! The timer of the ticks: SysTick, and a free-running clock that measures the lateness of the servo.

use core::hint::cold_path;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

use crate::build_error::BuildError;
use crate::period;

/// SysTick's clock in Hz: the emulated F405 runs at its full speed from the start.
const CORE_CLOCK: f64 = 168e6;

/// TIM2's registers, from the F405's memory map: control register 1, counter (of 32 bits), and
/// reload.
const CONTROL: *mut u32 = 0x4000_0000 as *mut u32;
pub const COUNTER: *const u32 = 0x4000_0024 as *const u32;
const RELOAD: *mut u32 = 0x4000_002C as *mut u32;
/// The rate of the clock in Hz: the emulated TIM2 counts nanoseconds, independently of the core.
const CLOCK: f64 = 1e9;

/// Periods that began without a tick.
static MISSED: AtomicU32 = AtomicU32::new(0);

/// Starts the clock.
pub fn start_clock() {
    // SAFETY: nothing else uses TIM2; with a full reload and the enable bit it runs freely.
    unsafe {
        RELOAD.write_volatile(u32::MAX);
        CONTROL.write_volatile(1);
    }
}

/// The clock.
#[inline(always)]
pub fn now() -> u32 {
    // SAFETY: TIM2's counter may be read at any time and without side effects.
    unsafe { COUNTER.read_volatile() }
}

/// The clock, read by its register's address, for a measurement that keeps the address between two readings.
///
/// # Safety
/// The address must be that of [`COUNTER`].
#[inline(always)]
pub unsafe fn now_at(counter: *const u32) -> u32 {
    // SAFETY: as in `now`.
    unsafe { counter.read_volatile() }
}

/// A period in counts of SysTick and of the clock.
#[derive(Clone, Copy, Debug)]
pub struct Period {
    reload: u32,
    clock_counts: u32,
}

impl Period {
    /// The period nearest to this many seconds.
    ///
    /// # Errors
    /// If a board cannot pace it. The 24 bits of SysTick would allow longer periods.
    pub fn of(seconds: f64) -> Result<Self, BuildError> {
        period::check(seconds)?;
        let reload = (seconds * CORE_CLOCK + 0.5) as u32 - 1;
        let clock_counts = (f64::from(reload + 1) * (CLOCK / CORE_CLOCK) + 0.5) as u32;
        Ok(Self { reload, clock_counts })
    }

    /// Clock counts in a period.
    pub const fn clock_counts(&self) -> u32 {
        self.clock_counts
    }
}

/// Starts the timer.
pub fn start(mut timer: SYST, period: Period) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(period.reload);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
}

/// Periods that began without a tick, since the start.
pub fn missed() -> u32 {
    MISSED.load(Ordering::Relaxed)
}

/// Counts the periods. The servo's interrupt owns it.
#[derive(Debug)]
pub struct TickTimer {
    /// Clock counts in a period.
    period: u32,
    /// Clock counts up to which a tick is in time.
    in_time: u32,
    /// The clock when the present period began.
    began: u32,
}

impl TickTimer {
    /// Counts from now on.
    pub fn new(period: Period) -> Self {
        let period = period.clock_counts;
        Self { period, in_time: period + period / 2, began: now() }
    }

    /// Periods that have begun since the last tick: 1 if it is in time. Call it at the beginning of a tick.
    #[inline(always)]
    pub fn periods_since_last(&mut self) -> u32 {
        let now = now();
        let since = now.wrapping_sub(self.began);
        // Up to half a period late, the period counts as beginning now: the two clocks have different
        // sources.
        if since <= self.in_time {
            self.began = now;
            return 1;
        }
        cold_path();
        // The clock may lag a little behind SysTick, by a negligible part of a period.
        let almost = since.wrapping_add(self.period / 64);
        let passed = almost.checked_div(self.period).unwrap_or(1).max(1);
        let whole = passed.wrapping_mul(self.period).min(since);
        self.began = self.began.wrapping_add(whole);
        MISSED.fetch_add(passed - 1, Ordering::Relaxed);
        passed
    }

    /// Clock counts since the present period began.
    #[inline(always)]
    pub fn time_in_period(&self) -> u32 {
        now().wrapping_sub(self.began)
    }

    /// Skips periods that the host has simulated without ticks.
    pub fn lose(&mut self, missed: u32) {
        self.began = self.began.wrapping_sub(missed.wrapping_mul(self.period));
    }
}
