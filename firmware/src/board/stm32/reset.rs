//! The cause of a reset by the chip's reset flags.

use embassy_stm32::pac::RCC;

use super::family::{BROWN_OUT, OPTION_BYTES, POWER_ON};
use crate::board::fault_memory;
use crate::reset::ResetCause;

/// Flags of RCC_CSR in both F4 and G4 (RM0090, 7.3.21; RM0440, 7.4.30), with different names for the
/// watchdogs. Every reset also pulls the pin low, so the pin is the cause only if its flag is alone.
const PIN: u32 = 1 << 26;
const SOFTWARE: u32 = 1 << 28;
const INDEPENDENT_WATCHDOG: u32 = 1 << 29;
const WINDOW_WATCHDOG: u32 = 1 << 30;
const LOW_POWER: u32 = 1 << 31;

/// Reads the flags and clears them for the next reset.
pub fn cause() -> ResetCause {
    let flags = RCC.csr().read().0;
    RCC.csr().modify(|w| w.set_rmvf(true));
    of_flags(flags, fault_memory::power_stayed())
}

/// Causes other than the supply come first, and the supply before the pin.
fn of_flags(flags: u32, power_stayed: bool) -> ResetCause {
    let is = |flag| flags & flag != 0;
    if is(INDEPENDENT_WATCHDOG) {
        ResetCause::IndependentWatchdog
    } else if is(WINDOW_WATCHDOG) {
        ResetCause::WindowWatchdog
    } else if is(LOW_POWER) {
        ResetCause::LowPower
    } else if is(SOFTWARE) {
        ResetCause::Software
    } else if is(OPTION_BYTES) {
        ResetCause::OptionBytes
    } else if is(POWER_ON) && !power_stayed {
        ResetCause::PowerOn
    } else if is(POWER_ON | BROWN_OUT) {
        ResetCause::BrownOut
    } else if is(PIN) {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}
