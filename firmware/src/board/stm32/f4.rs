//! Registers specific to the F405 (RM0090).

use embassy_stm32::pac::{DBGMCU, FLASH, RCC};

use crate::fault::Fault;

/// RCC_CSR: the supply was switched on.
pub const POWER_ON: u32 = 1 << 27;
/// RCC_CSR: the supply was below the brown-out level, but not off.
pub const BROWN_OUT: u32 = 1 << 25;
/// RCC_CSR: the option bytes were loaded; the chip has no such flag.
pub const OPTION_BYTES: u32 = 0;

/// TIM6's update among the triggers of the F4's DAC (RM0090, DAC external triggers).
pub const TIMER_TRIGGER: u8 = 0;

/// The cause of the non-maskable interrupt: the chip has only one.
pub fn non_maskable() -> Fault {
    if RCC.cir().read().cssf() { Fault::ClockLost } else { Fault::NonMaskable }
}

/// The chip's identifier in DBGMCU_IDCODE, and its first revision. Chips of this revision, some of which
/// report another identifier, must not prefetch (ES0182).
const F405: u16 = 0x413;
const REVISION_A: u16 = 0x1000;

/// Full speed: enables the caches and the prefetching of the flash memory: it has five wait states at 168 MHz, and
/// the clock set-up clears the other bits of that register.
pub fn full_speed() {
    let chip = DBGMCU.idcode().read();
    FLASH.acr().modify(|w| {
        w.set_icen(true);
        w.set_dcen(true);
        w.set_prften(chip.dev_id() == F405 && chip.rev_id() != REVISION_A);
    });
}

/// Keeps the watchdog running while a debugger halts the core.
pub fn keep_watchdog_running() {
    DBGMCU.apb1fzr().modify(|w| w.set_iwdg(false));
}

/// Whether the brown-out level is below the 2.7 V that 168 MHz with five wait states need (RM0090, 3.5.1); then
/// it is a warning in the log, too. A new chip has no brown-out level set.
pub fn has_low_brown_out() -> bool {
    let level = FLASH.optcr().read().bor_lev();
    let is_low = level != 0;
    if is_low {
        defmt::warn!(
            "brown-out level {=u8} lets the core run at 168 MHz below the 2.7 V that this needs: \
             set the option byte BOR_LEV to 0 (2.7 V) with STM32_Programmer_CLI -c port=SWD \
             -ob BOR_LEV=0",
            level
        );
    }
    is_low
}
