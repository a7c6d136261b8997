//! The count of a quadrature encoder at each update of the modulation and at the index, both captured by its timer, so
//! that no late interrupt makes a count late (RM0440, general-purpose timers).
//!
//! Channel 4 of TIM4 captures on TRC, which is TIM1's trigger output by the timers' interconnection, and encoder mode
//! does not use that input. Any channel can capture on TRC; the third has its pin at the encoder's connector, and
//! captures at the rising edge of the index.

use embassy_stm32::pac;
use embassy_stm32::pac::gpio::vals::Moder;
use embassy_stm32::pac::timer::vals::{CcmrInputCcs, Ts};

use crate::board::stm32::wiring::{ENCODER, INDEX};
use crate::encoder::RawCount;

/// TIM1's trigger output among the triggers of TIM4 (RM0440, table of their interconnection).
const TIM1_TRGO: Ts = Ts::ITR0;

/// The channel of the index, from zero.
const CHANNEL: usize = 2;

/// The pin of the index, and the alternate function that connects it to the timer.
#[derive(Clone, Copy)]
pub struct IndexPin {
    /// Its port.
    pub port: pac::gpio::Gpio,
    /// Its number in the port, 0 to 15.
    pub pin: usize,
    /// The alternate function.
    pub function: u8,
}

/// Sets up the capture of the count at each update of TIM1.
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

/// Starts the capture at each index, with the filter of the encoder's other inputs, so that the edges of all
/// three inputs have the same delay.
pub fn capture_index() {
    let filter = ENCODER.ccmr_input(0).read().icf(0);
    ENCODER.ccmr_input(1).modify(|w| {
        w.set_ccs(CHANNEL % 2, CcmrInputCcs::TI4);
        w.set_icf(CHANNEL % 2, filter);
    });
    INDEX.port.afr(INDEX.pin / 8).modify(|w| w.set_afr(INDEX.pin % 8, INDEX.function));
    INDEX.port.moder().modify(|w| w.set_moder(INDEX.pin, Moder::ALTERNATE));
    ENCODER.ccer().modify(|w| w.set_cce(CHANNEL, true));
}

/// Discards an earlier index, because the encoder was set to zero since.
pub fn forget_index() {
    ENCODER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_ccif(CHANNEL, false);
    });
}

/// Whether an index has come since the last was [taken](take_index).
#[inline(always)]
pub fn has_index() -> bool {
    ENCODER.sr().read().ccif(CHANNEL)
}

/// The count at the last index; the read acknowledges it.
pub fn take_index() -> RawCount {
    RawCount::from(ENCODER.ccr(CHANNEL).read().ccr())
}
