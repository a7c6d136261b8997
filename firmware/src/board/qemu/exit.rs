//! Ends a program on the emulated board.

use super::lines;

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
    defmt::error!("refused by {=str}", reason);
    #[cfg(not(feature = "log"))]
    let _ = reason;
    semihosting::process::exit(EXIT_REFUSED)
}
