//! The end of a program by a fault.

use super::{lines, lockstep};
use crate::board::fault_memory;
use crate::fault::Fault;
use crate::servo_loop::State;

/// Ends the program because of a fault: no torque, amplifier off, a record for the next boot, and
/// a reset, for which other boards need a watchdog.
pub fn end(fault: Fault) -> ! {
    cortex_m::interrupt::disable();
    lines::stop();
    fault_memory::store_fault(fault);
    // SAFETY: a host that has asked has done so through the pipes, so they are open.
    unsafe { lockstep::show(State::Faulted) };
    cortex_m::peripheral::SCB::sys_reset()
}
