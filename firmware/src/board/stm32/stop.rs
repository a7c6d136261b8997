//! What a panic and a fault do: no torque, amplifier off, and a wait for the watchdog.

use core::panic::PanicInfo;

use super::wiring::{AMPLIFIER, CONVERTER};

/// Takes the torque away, by registers alone: it works with whatever is left of the program.
pub fn stop() {
    AMPLIFIER.set(false);
    CONVERTER.stop();
}

/// None is reachable by input; this is for mistakes.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    stop();
    loop {
        cortex_m::asm::nop();
    }
}
