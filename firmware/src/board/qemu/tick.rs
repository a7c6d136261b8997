//! A tick with the world around it: the host moves the encoder before, and sees the board's lines
//! after.

use super::lockstep;
#[cfg(feature = "log")]
use super::{lines, log, meter};
use crate::servo_loop::State;

/// One interrupt. `tick` has the code of other boards' timer interrupt, from its first instruction to its
/// last, and is measured as such; `state` is the state of the servo, and `lose` receives the number of
/// periods without a tick.
///
/// # Safety
/// The pipes must be open.
#[inline(always)]
pub unsafe fn with(tick: extern "C" fn(), state: impl Fn() -> State, lose: impl FnOnce(u32)) {
    #[cfg(feature = "log")]
    let begin = meter::now();
    // SAFETY: the pipes are open, as the caller promises.
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
    // SAFETY: this is the interrupt that the queue is for, enabled after the log was opened.
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

/// The host has ended the run; where there is a log, that is finished first.
fn ended() {
    #[cfg(feature = "log")]
    log::end();
    #[cfg(not(feature = "log"))]
    semihosting::process::exit(super::exit::EXIT_DONE)
}
