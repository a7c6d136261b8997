//! Periods that every board can pace.

use crate::build_error::BuildError;

/// Periods without a tick after which the watchdog resets the board. Its clock is an RC oscillator:
/// on the F405, the worst, eight periods by its nominal 32 kHz are between five and fifteen.
pub const PATIENCE: f64 = 8.0;
/// Rate of the watchdog's clock in Hz, after its reset prescaler of 4.
pub const WATCHDOG_CLOCK: f64 = 32_000.0 / 4.0;
/// Largest start of the watchdog's count.
const WATCHDOG_LONGEST: f64 = 4095.0;

/// The shortest period in s: 1700 cycles of a board's processor. A tick takes some hundreds of them,
/// and the tasks below need the most.
pub const SHORTEST: f64 = 1e-5;
/// The longest period in s for which the watchdog can wait [`PATIENCE`] periods.
pub const LONGEST: f64 = (WATCHDOG_LONGEST - 1.0) / WATCHDOG_CLOCK / PATIENCE;

/// The starting count of an STM32's watchdog, to reset the board after [`PATIENCE`] periods of this many
/// seconds without a tick.
///
/// ```
/// assert_eq!(haptic_servo::period::watchdog_counts(0.001), 65);
/// ```
pub const fn watchdog_counts(seconds: f64) -> u16 {
    // One more count covers the cast's rounding.
    (PATIENCE * seconds * WATCHDOG_CLOCK + 1.0) as u16
}

/// Rejects any other period.
///
/// # Errors
/// [`BuildError::Period`].
pub const fn check(period: f64) -> Result<(), BuildError> {
    // Written so that NaN is refused.
    if period >= SHORTEST && period <= LONGEST {
        Ok(())
    } else {
        Err(BuildError::Period { period, shortest: SHORTEST, longest: LONGEST })
    }
}

/// For constants: a compile error if no board can pace the period.
///
/// # Panics
/// If no board can; in a constant this is a compile error.
#[track_caller]
pub const fn checked(period: f64) {
    if let Err(error) = check(period) {
        error.refuse();
    }
}
