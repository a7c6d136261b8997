//! How a program on the emulated board ends.

use super::lines;

/// Exit status of a run that the host ended.
pub const EXIT_DONE: i32 = 0;
/// Exit status of a program that could not start, for a logged reason.
pub const EXIT_REFUSED: i32 = 1;

/// Ends a program that cannot start. Where this machine refuses a scene that passed when it was compiled,
/// the host has the words for it: `haptic certify`.
#[cold]
pub(super) fn halt_with(reason: &'static str) -> ! {
    lines::stop();
    #[cfg(feature = "log")]
    defmt::error!("refused by {=str}", reason);
    #[cfg(not(feature = "log"))]
    let _ = reason;
    semihosting::process::exit(EXIT_REFUSED)
}
