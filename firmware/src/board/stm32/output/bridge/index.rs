//! The index of the encoder: at its rising edge, channel 3 of the encoder's timer captures the count (RM0440,
//! general-purpose timers), so that no index is missed or late at any speed.

use embassy_stm32::pac;
use embassy_stm32::pac::gpio::vals::Moder;
use embassy_stm32::pac::timer::vals::CcmrInputCcs;

use crate::board::stm32::wiring::{ENCODER, INDEX};
use crate::encoder::RawCount;

/// The channel, from zero.
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

/// Starts the capture at each index, with the filter of the encoder's other inputs, so that the edges of all
/// three inputs have the same delay.
pub fn capture() {
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
pub fn forget() {
    ENCODER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_ccif(CHANNEL, false);
    });
}

/// Whether an index has come since the last was [taken](take).
#[inline(always)]
pub fn has_come() -> bool {
    ENCODER.sr().read().ccif(CHANNEL)
}

/// The count at the last index; the read acknowledges it.
pub fn take() -> RawCount {
    RawCount::from(ENCODER.ccr(CHANNEL).read().ccr())
}
