//! The timer of the ticks: a basic timer whose update starts the servo's interrupt and latches the DAC, and a
//! free-running clock that measures the lateness of the servo.
//!
//! Both count the same clock, so that a period is a whole number of the clock's counts and the two
//! cannot drift apart.
//!
//! With a fixed phase, a second basic timer latches the DAC in place of the first. It has the same clock,
//! prescaler and reload value, and its counter lags by the phase, so that each of its updates is later by the
//! phase.
//!
//! ```text
//! TIM6     0 ......... reload|0 ......... reload|0        update: the tick's interrupt
//! TIM7     reload-p..|0 ......... reload-p..|0 .......    update: the DAC, p + 1 counts later
//! ```
//!
//! A compare channel is not used: the basic timers have none, and no other timer that counts TIM6's clock and
//! triggers the DACs of both families is free on all boards. TIM7 is free on each of them.

use core::num::NonZeroU32;

use embassy_stm32::pac;
use embassy_stm32::pac::timer::vals::{Mms, Urs};
use embassy_stm32::peripherals;
use embassy_stm32::rcc;

use super::pace::{Pace, now};
#[cfg(not(feature = "magnetic"))]
use crate::board::stm32::quadrature::Counter;
#[cfg(not(feature = "magnetic"))]
use crate::board::stm32::wiring::ENCODER;
use crate::board::stm32::wiring::TIMER_CLOCK;
use crate::build_error::BuildError;
#[cfg(not(feature = "magnetic"))]
use crate::encoder::RawCount;
use crate::output_timing::OutputTiming;
use crate::period;
#[cfg(not(feature = "magnetic"))]
use crate::servo_loop::READ_WITHIN;

/// The pacing timer on all boards: a basic timer, whose update can trigger the DAC of all these chips.
const TIMER: pac::timer::TimBasic = pac::TIM6;

/// The timer of a phase, on all boards.
const PHASE_TIMER: pac::timer::TimBasic = pac::TIM7;

#[derive(Clone, Copy, Debug)]
struct Period {
    /// Clock counts for one count of the timer.
    prescale: u32,
    counts: u32,
    /// Clock counts per second.
    clock: f64,
}

impl Period {
    /// The longest period of at most this many seconds. A longer period would need more of the device's
    /// passivity than was certified; a shorter period does not, because the coefficients do not change.
    ///
    /// # Errors
    /// If the board cannot pace it: see [`period`](period::check).
    fn of(seconds: f64) -> Result<Self, BuildError> {
        period::check(seconds)?;
        let clock = TIMER_CLOCK;
        let wanted = seconds * clock;
        // The prescaler with the nearest period, beginning with the smallest that fits, which has the finest
        // steps. Usual periods are whole numbers of counts with one of the next few prescalers, up to the
        // rounding of the product. All casts round down positive, small numbers.
        let first = (wanted / MOST) as u32 + 1;
        let with = |prescale: u32| {
            let counts = ((wanted / f64::from(prescale) + 1e-6) as u32).min(MOST as u32);
            Self { prescale, counts, clock }
        };
        let mut nearest = with(first);
        for prescale in first + 1..first + PRESCALERS {
            let other = with(prescale);
            if other.off(wanted) < nearest.off(wanted) {
                nearest = other;
            }
        }
        Ok(nearest)
    }

    /// The deviation from the wanted period in clock counts.
    fn off(&self, wanted: f64) -> f64 {
        (f64::from(self.prescale * self.counts) - wanted).abs()
    }

    fn clock_counts(&self) -> NonZeroU32 {
        // Both factors are at least one.
        NonZeroU32::new(self.prescale * self.counts).unwrap_or(NonZeroU32::MIN)
    }

    /// Counts of the timer in this many seconds, at least one and less than a period; rounded up, so that no
    /// torque comes before its stated time.
    fn counts_in(&self, seconds: f64) -> u32 {
        // The cast rounds down. The precision of a time is that of its decimal digits.
        let counts = (seconds * self.clock / f64::from(self.prescale) + (1.0 - 1e-6)) as u32;
        counts.clamp(1, self.counts - 1)
    }

    /// The paced period in s.
    fn seconds(&self) -> f64 {
        f64::from(self.clock_counts().get()) / self.clock
    }
}

/// The number of prescalers to try.
const PRESCALERS: u32 = 16;
/// The number of values of a 16-bit counter.
const MOST: f64 = 65_536.0;

/// Sets up the timers for a period in s and does not start them. The servo's interrupt must still be disabled.
///
/// # Errors
/// If the board cannot pace it: see [`period`](period::check).
pub fn prepare(seconds: f64, timing: OutputTiming) -> Result<Pace, BuildError> {
    let period = Period::of(seconds)?;
    rcc::enable_and_reset::<peripherals::TIM6>();
    set_up(TIMER, period);
    TIMER.dier().write(|w| {
        // With a magnetic encoder the update begins its transfer, whose end is the tick.
        w.set_ude(cfg!(feature = "magnetic"));
        w.set_uie(cfg!(not(feature = "magnetic")));
    });
    if let Some(phase) = timing.phase() {
        rcc::enable_and_reset::<peripherals::TIM7>();
        set_up(PHASE_TIMER, period);
        let behind = period.counts - period.counts_in(phase);
        // TIM7_CNT: it overflows `phase` counts after the start, and then once per period.
        PHASE_TIMER.cnt().write(|w| w.set_cnt(behind as u16));
    }
    let counts = period.clock_counts();
    // The update itself takes the reading of a magnetic encoder, however late its tick is. The cast saturates.
    #[cfg(feature = "magnetic")]
    let in_time = Pace::in_time_of_hardware(counts.get());
    #[cfg(not(feature = "magnetic"))]
    let in_time = (period.clock * READ_WITHIN) as u32;
    Ok(Pace::new(counts, period.seconds(), in_time))
}

/// Starts the clock before the timer, and the timer of a phase last, so that no torque comes before its phase. The
/// torque is later by the two accesses, some tens of nanoseconds; a count is read later by more than that.
pub fn start(pace: &mut Pace, timing: OutputTiming) {
    pace.start(|| {
        TIMER.cr1().modify(|w| w.set_cen(true));
        if timing.phase().is_some() {
            PHASE_TIMER.cr1().modify(|w| w.set_cen(true));
        }
    });
}

/// The encoder's count.
#[cfg(not(feature = "magnetic"))]
#[inline(always)]
pub fn count() -> RawCount {
    ENCODER.count()
}

/// Acknowledges the tick, whose period may count as begun now.
#[inline(always)]
pub fn period_began() -> u32 {
    // Nothing waits for the flag where the end of a transfer paces the ticks.
    #[cfg(not(feature = "magnetic"))]
    TIMER.sr().write(|w| w.set_uif(false));
    now()
}

/// Sets a basic timer's period and makes its update its trigger output, without starting it.
///
/// The registers TIMx_PSC, ARR, CR1, CR2, EGR and SR of the basic timers are the same in RM0440 and RM0090.
/// The update that EGR makes here is a trigger, too: the DAC must not listen yet.
fn set_up(timer: pac::timer::TimBasic, period: Period) {
    timer.psc().write_value((period.prescale - 1) as u16);
    timer.arr().write(|w| w.set_arr((period.counts - 1) as u16));
    // CR2.MMS: the update triggers the DAC if the DAC is set to this timer.
    timer.cr2().write(|w| w.set_mms(Mms::UPDATE));
    // Prescaler and period take effect at an update; this update must not cause a tick. It also restarts the
    // prescaler's count, so that two timers started together count together.
    timer.cr1().write(|w| w.set_urs(Urs::COUNTER_ONLY));
    timer.egr().write(|w| w.set_ug(true));
    timer.sr().write(|w| w.set_uif(false));
}
