//! The angle of a magnetic encoder at each update of the modulation. TIM1 begins a transfer before each update, so that
//! it has ended there, and the current interrupt takes it.
//!
//! ```text
//! counter  \        /\        /
//!           \      /  \      /
//! channel 4  x    /    x    /          on the way down: DMA enables the SPI, which selects the chip
//!            |\  /     |\  /
//! update     | \/      | \/            the interrupt takes the words
//! SPI        |==|      |==|
//! ```
//!
//! An absolute angle has its index at zero, at all times: the phase of a motor that was aligned once and stated is known
//! from the first reading on.

use super::super::{off, pwm, tell};
use crate::board::stm32::magnetic::{self, Setup};
use crate::board::stm32::wiring::TIMER_CLOCK;
use crate::encoder::RawCount;
use crate::magnetic::Transfers;

/// Has TIM1 begin a transfer before each update, once it counts.
pub fn pace(setup: &'static Setup) {
    pwm::request_before_update(Transfers::lead_counts(setup.chip, TIMER_CLOCK));
}

/// The angle at the last update: that of the last transfer, or for some failed ones the angle before. If more have
/// failed, the gates are off.
#[inline(always)]
pub fn position(setup: &'static Setup) -> RawCount {
    magnetic::take(setup, off);
    if let Some(fault) = magnetic::fault() {
        core::hint::cold_path();
        off();
        tell(fault);
    }
    magnetic::count()
}
