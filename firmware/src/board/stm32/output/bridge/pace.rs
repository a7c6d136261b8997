//! When a tick is due with the bridge: its current interrupt pends the servo's at every so many updates
//! of TIM1.
//!
//! The count is not read late, whenever that interrupt comes: each update of TIM1 has the encoder's timer
//! capture it (RM0440, general-purpose timers: channel 4 of TIM4 captures on TRC, which is TIM1's trigger
//! output by the timers' interconnection, and encoder mode leaves that input free). Any channel captures on
//! TRC; the third is the one whose pin is at the encoder's connector, and captures its [index](super::index).

use core::num::NonZeroU32;
use core::sync::atomic::{AtomicU32, Ordering};

use embassy_stm32::pac::timer::vals::{CcmrInputCcs, Ts};
use embassy_stm32::{peripherals, rcc};

use super::pwm;
use crate::board::stm32::output::periods::Periods;
use crate::board::stm32::wiring::ENCODER;
use crate::encoder::RawCount;

/// The clock when the count of the present period was read, and that count.
static TIME: AtomicU32 = AtomicU32::new(0);
static COUNT: AtomicU32 = AtomicU32::new(0);

/// TIM1's trigger output among the triggers of TIM4 (RM0440, table of their interconnection).
const TIM1_TRGO: Ts = Ts::ITR0;

/// Has each update of TIM1 capture the encoder's count.
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

/// Takes the count of a period down, and the time.
#[inline(always)]
pub fn begin_period(count: RawCount, now: u32) {
    COUNT.store(count.bits(), Ordering::Relaxed);
    TIME.store(now, Ordering::Relaxed);
}

/// What paces the servo by its bridge. Belongs to the servo's interrupt.
#[derive(Debug)]
pub struct Pace {
    periods: Periods,
}

impl Pace {
    /// A period of this many clock counts, with so many in each PWM period, after which the next count is captured
    /// over this one.
    pub fn new(period: NonZeroU32, in_time: u32) -> Self {
        capture_counts();
        let clock = f64::from(rcc::frequency::<peripherals::TIM2>().0);
        Self { periods: Periods::new(period, f64::from(period.get()) / clock, in_time) }
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
    /// [`Hardware::periods_since_last`](crate::servo_loop::Hardware::periods_since_last). Late is an
    /// interrupt of the current loop that missed its update.
    #[inline(always)]
    pub fn periods_since_last(&mut self) -> u32 {
        self.periods.begun_by(TIME.load(Ordering::Relaxed))
    }

    /// The period that has begun, and its time.
    #[inline(always)]
    pub const fn periods(&self) -> &Periods {
        &self.periods
    }
}
