//! Why the chip was reset, by its reset flags.

use embassy_stm32::pac::RCC;

use super::family::{BROWN_OUT, OPTION_BYTES, POWER_ON};
use crate::board::fault_memory;
use crate::reset::ResetCause;

/// Flags of RCC_CSR that the F4's and the G4's have in common (RM0090, 7.3.21; RM0440, 7.4.30), the
/// watchdogs' under different names. Every reset pulls the pin low, too, so the pin is the cause
/// only if its flag is alone.
const PIN: u32 = 1 << 26;
const SOFTWARE: u32 = 1 << 28;
const INDEPENDENT_WATCHDOG: u32 = 1 << 29;
const WINDOW_WATCHDOG: u32 = 1 << 30;
const LOW_POWER: u32 = 1 << 31;

/// Reads the flags and clears them: the next reset may have another cause.
pub fn cause() -> ResetCause {
    let flags = RCC.csr().read().0;
    RCC.csr().modify(|w| w.set_rmvf(true));
    of_flags(flags, fault_memory::power_stayed())
}

/// What resets a chip later than its supply is named first, and the supply itself before the pin.
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
