//! The index of the encoder: its rising edge has channel 3 of the encoder's timer capture the count (RM0440,
//! general-purpose timers), so that none is missed or late, however fast the handle is.

use embassy_stm32::pac;
use embassy_stm32::pac::gpio::vals::Moder;
use embassy_stm32::pac::timer::vals::CcmrInputCcs;

use crate::board::stm32::wiring::{ENCODER, INDEX};
use crate::encoder::RawCount;

/// The channel, from zero.
const CHANNEL: usize = 2;

/// The pin of the index, and the alternate function by which it is the timer's.
#[derive(Clone, Copy)]
pub struct IndexPin {
    /// Its port.
    pub port: pac::gpio::Gpio,
    /// Its number in the port, 0 to 15.
    pub pin: usize,
    /// The alternate function.
    pub function: u8,
}

/// Has each index capture the count, through the filter of the encoder's other inputs, so that the edges of all
/// three are as late.
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

/// Forgets an index that came before: the encoder has been made zero since.
pub fn forget() {
    ENCODER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_ccif(CHANNEL, false);
    });
}

/// Whether an index has come since the last one was [taken](take).
#[inline(always)]
pub fn has_come() -> bool {
    ENCODER.sr().read().ccif(CHANNEL)
}

/// The count at the last index; the read acknowledges it.
pub fn take() -> RawCount {
    RawCount::from(ENCODER.ccr(CHANNEL).read().ccr())
}
