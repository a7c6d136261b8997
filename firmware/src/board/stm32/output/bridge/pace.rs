//! The pace of the servo with the bridge: the current interrupt pends the servo's interrupt at a fixed number
//! of updates of TIM1.
//!
//! A late interrupt does not make the count late: at each update of TIM1 the encoder's timer captures the
//! count (RM0440, general-purpose timers: channel 4 of TIM4 captures on TRC, which is TIM1's trigger output
//! by the timers' interconnection, and encoder mode does not use that input). Any channel can capture on TRC;
//! the third has its pin at the encoder's connector, and captures the [index](super::index).

use core::num::NonZeroU32;
use core::sync::atomic::{AtomicU32, Ordering};

use embassy_stm32::pac::timer::vals::{CcmrInputCcs, Ts};

use super::pwm;
use crate::board::stm32::output::periods::Periods;
use crate::board::stm32::wiring::{ENCODER, TIMER_CLOCK};
use crate::encoder::RawCount;

/// The clock when the count of the present period was read, and that count.
static TIME: AtomicU32 = AtomicU32::new(0);
static COUNT: AtomicU32 = AtomicU32::new(0);

/// TIM1's trigger output among the triggers of TIM4 (RM0440, table of their interconnection).
const TIM1_TRGO: Ts = Ts::ITR0;

/// Sets up the capture of the encoder's count at each update of TIM1.
pub fn capture_counts() {
    ENCODER.smcr().modify(|w| w.set_ts(TIM1_TRGO));
    ENCODER.ccmr_input(1).modify(|w| w.set_ccs(1, CcmrInputCcs::TRC));
    ENCODER.ccer().modify(|w| w.set_cce(3, true));
}

/// The count at the last update.
#[inline(always)]
pub fn captured() -> RawCount {
    RawCount::from(ENCODER.ccr(3).read().ccr())
}

/// Stores the count and the time of a period's beginning.
#[inline(always)]
pub fn begin_period(count: RawCount, now: u32) {
    COUNT.store(count.bits(), Ordering::Relaxed);
    TIME.store(now, Ordering::Relaxed);
}

/// Paces the servo by the bridge. The servo's interrupt owns it.
#[derive(Debug)]
pub struct Pace {
    periods: Periods,
}

impl Pace {
    /// A period of `period` clock counts; a tick is in time within `in_time` of them, which is a PWM period,
    /// after which the next capture overwrites the count.
    pub fn new(period: NonZeroU32, in_time: u32) -> Self {
        capture_counts();
        let seconds = f64::from(period.get()) / TIMER_CLOCK;
        Self { periods: Periods::new(period, seconds, in_time) }
    }

    /// Starts the clock and then TIM1.
    pub fn start(&mut self) {
        self.periods.start(pwm::start);
    }

    /// The encoder's count at the beginning of the period.
    #[inline(always)]
    pub fn count(&self) -> RawCount {
        RawCount::from(COUNT.load(Ordering::Relaxed) as u16)
    }

    /// The periods that have begun since the last time: see
    /// [`Hardware::periods_since_last`](crate::servo_loop::Hardware::periods_since_last). A tick is late if
    /// the interrupt of the current loop missed its update.
    #[inline(always)]
    pub fn periods_since_last(&mut self) -> u32 {
        self.periods.begun_by(TIME.load(Ordering::Relaxed))
    }

    /// The periods and their time.
    #[inline(always)]
    pub const fn periods(&self) -> &Periods {
        &self.periods
    }
}
