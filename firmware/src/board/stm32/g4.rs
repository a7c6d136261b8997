//! Registers specific to the G4 chips (RM0440).

use embassy_stm32::pac::{DBGMCU, FLASH, RCC, SYSCFG};

use super::clock_170;
use crate::fault::Fault;

/// RCC_CSR: the supply was below the brown-out level or was switched on; the chip does not distinguish the
/// two.
pub const POWER_ON: u32 = 1 << 27;
/// RCC_CSR: a brown-out alone; the chip has no such flag.
pub const BROWN_OUT: u32 = 0;
/// RCC_CSR: the option bytes were loaded.
pub const OPTION_BYTES: u32 = 1 << 25;

/// TIM6's update among the triggers of the G4's DAC1 (RM0440, table of its interconnections).
#[cfg(not(feature = "bridge"))]
pub const TIMER_TRIGGER: u8 = 7;

/// The cause of the non-maskable interrupt.
pub fn non_maskable() -> Fault {
    if RCC.cifr().read().cssf() {
        return Fault::ClockLost;
    }
    let errors = FLASH.eccr().read();
    if errors.eccd() || errors.eccd2() {
        return Fault::FlashEcc { address: errors.addr_ecc(), status: errors.0 };
    }
    if SYSCFG.cfgr2().read().spf() { Fault::RamParity } else { Fault::NonMaskable }
}

/// Full speed: the whole system clock, and both caches of the flash memory, which are on after reset. Nothing here
/// relies on them: the code of each tick is in core-coupled memory.
pub fn full_speed() {
    clock_170::undivide();
    FLASH.acr().modify(|w| {
        w.set_icen(true);
        w.set_dcen(true);
    });
}

/// Keeps the watchdog running while a debugger halts the core.
pub fn keep_watchdog_running() {
    DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(false));
}

/// Whether the brown-out level is too low for the board; then it is a warning in the log, too. The core may run
/// at 170 MHz down to the lowest level, but the DAC's buffer only works down to 1.8 V (DS12288).
pub fn has_low_brown_out() -> bool {
    let is_low = FLASH.optr().read().bor_lev() == 0;
    if is_low {
        defmt::warn!(
            "brown-out level 0 lets the chip run down to 1.6 V; its DAC needs 1.8 V: set the \
             option byte BOR_LEV to 4 (2.8 V) with STM32_Programmer_CLI -c port=SWD -ob BOR_LEV=4"
        );
    }
    is_low
}
