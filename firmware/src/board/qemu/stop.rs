//! Ends a program: after a fault, or because it cannot start.

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

/// Exit status of a run that the host ended.
pub const EXIT_DONE: i32 = 0;
/// Exit status of a program that could not start, for a logged reason.
pub const EXIT_REFUSED: i32 = 1;

/// Ends a program that cannot start. If this machine refuses a scene that passed at compile time,
/// `haptic certify` on the host prints the reason.
#[cold]
pub(super) fn halt_with(reason: &'static str) -> ! {
    lines::stop();
    #[cfg(feature = "log")]
    semihosting::println!("refused by {reason}");
    #[cfg(not(feature = "log"))]
    let _ = reason;
    semihosting::process::exit(EXIT_REFUSED)
}
