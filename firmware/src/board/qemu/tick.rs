//! A tick with the exchange with the host around it: the host sets the encoder before, and reads the board's
//! outputs after.

use super::lockstep;
#[cfg(feature = "log")]
use super::{lines, log, meter};
use crate::servo_loop::State;

/// One interrupt. `tick` is the code of other boards' timer interrupt, and is measured from its first
/// instruction to its last; `state` is the state of the servo, and `lose` receives the number of periods
/// without a tick.
///
/// # Safety
/// The pipes must be open.
#[inline(always)]
pub unsafe fn with(tick: extern "C" fn(), state: impl Fn() -> State, lose: impl FnOnce(u32)) {
    #[cfg(feature = "log")]
    let begin = meter::now();
    // SAFETY: the caller guarantees that the pipes are open.
    match unsafe { lockstep::receive() } {
        Some(0) => {}
        Some(missed) => lose(missed),
        None => return ended(),
    }
    #[cfg(feature = "log")]
    let (before, start) = (state(), meter::now());
    #[cfg(feature = "log")]
    let time = meter::interrupt(tick);
    #[cfg(not(feature = "log"))]
    tick();
    #[cfg(feature = "log")]
    let end = meter::now();
    // SAFETY: as above.
    unsafe { lockstep::show(state()) };
    #[cfg(feature = "log")]
    // SAFETY: this is the interrupt of the queue, enabled after the log was opened.
    unsafe {
        log::push(log::Measured {
            count: lines::count(),
            code: lines::outputs().0,
            was_running: before == State::Running,
            tick: time,
            lockstep: meter::now().wrapping_sub(end).wrapping_add(start.wrapping_sub(begin)),
        });
        log::spend(meter::now().wrapping_sub(begin));
    };
}

/// Handles the end of the run by the host; a log is finished first.
fn ended() {
    #[cfg(feature = "log")]
    log::end();
    #[cfg(not(feature = "log"))]
    semihosting::process::exit(super::stop::EXIT_DONE)
}
