//! Ends a program after a fault.

use super::{lines, lockstep};
use crate::board::fault_memory;
use crate::fault::Fault;
use crate::servo_loop::State;

/// Ends the program after a fault: no torque, amplifier off, a record for the next boot, and a reset, for
/// which other boards use the watchdog.
pub fn end(fault: Fault) -> ! {
    cortex_m::interrupt::disable();
    lines::stop();
    fault_memory::store_fault(fault);
    // SAFETY: `show` uses the pipes only after a request, which came through the open pipes.
    unsafe { lockstep::show(State::Faulted) };
    cortex_m::peripheral::SCB::sys_reset()
}
