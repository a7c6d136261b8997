//! What a fault leaves behind: no torque, amplifier off, a record for the next boot, and a wait for
//! the watchdog, which resets the board.

use super::{family, output};
use crate::board::fault_memory;
use crate::fault::Fault;

/// Removes the torque by registers alone: it works in any state of the program.
pub fn stop() {
    output::off();
    output::stop();
}

/// Ends the program because of a non-maskable interrupt: an error of the flash memory, of RAM, or of the
/// crystal, without which the core runs on by its internal oscillator.
pub fn end_non_maskable() -> ! {
    // First, as reading the cause may fault as well.
    output::off();
    end(family::non_maskable())
}

/// Ends the program because of a fault. The servo's interrupt comes no more, so the watchdog resets
/// the board; where it does not run yet, the amplifier has never been on, and the board stays as it
/// is, for a person to look at.
pub fn end(fault: Fault) -> ! {
    cortex_m::interrupt::disable();
    // The record before the rest: a register that does not answer ends all that is behind it.
    output::off();
    fault_memory::store_fault(fault);
    output::stop();
    loop {
        cortex_m::asm::nop();
    }
}
