//! Ends a program after a fault: no torque, amplifier off, a record for the next boot, and a wait for the
//! watchdog, which resets the board.

use super::{family, output};
use crate::board::fault_memory;
use crate::fault::Fault;

/// Removes the torque by registers alone: it works in any state of the program.
pub fn stop() {
    output::off();
    output::stop();
}

/// Ends the program after a non-maskable interrupt: an error of the flash memory, of RAM, or of the crystal,
/// after which the core continues with its internal oscillator.
pub fn end_non_maskable() -> ! {
    // First, because reading the cause may also fault.
    output::off();
    end(family::non_maskable())
}

/// Ends the program after a fault. The servo's interrupt stops, so the watchdog resets the board. If the
/// watchdog does not run yet, the amplifier has never been on, and the board stays in this state for
/// inspection.
pub fn end(fault: Fault) -> ! {
    cortex_m::interrupt::disable();
    // The record before the rest, because an access to a register may fail and end everything after it.
    output::off();
    fault_memory::store_fault(fault);
    output::stop();
    loop {
        cortex_m::asm::nop();
    }
}
