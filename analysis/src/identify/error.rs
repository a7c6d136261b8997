//! Why a record identifies nothing.

use thiserror::Error;

use super::step::{LEAST_PERIODS, LeftOut};
use crate::quantity::significant;
use crate::table::TableError;

/// Why a record identifies nothing.
#[derive(Debug, Error)]
pub enum IdentifyError {
    /// The file.
    #[error(transparent)]
    Record(#[from] TableError),
    /// No stretch of steady sine.
    #[error(
        "the torque has no steady sine of at least {} periods{}",
        LEAST_PERIODS, reasons(.0)
    )]
    NoSteps(Vec<LeftOut>),
    /// The torque on the device differs from the record.
    #[error(
        "the sine of {} N m at {} Hz moved the device by a torque with {:.1} % \
         of harmonics that were not commanded: the amplifier clips there, at its limit of current or \
         of voltage. Lower the amplitude of this tone and of those above it \
         (firmware/src/bin/identify.rs), or raise the amplifier's limit, and measure again",
        significant(*.amplitude, 3),
        significant(*.frequency, 3),
        100.0 * .part
    )]
    Clipped {
        /// Frequency in Hz.
        frequency: f64,
        /// Amplitude of the command in N m.
        amplitude: f64,
        /// The largest harmonic as a part of it.
        part: f64,
    },
    /// The fit has more unknowns than equations, or the frequencies are the same.
    #[error(
        "{usable} of {found} sines can be used; a fit of inertia, damping, lag and delay needs at \
         least 3 at different frequencies{}", reasons(.left_out)
    )]
    TooFew {
        /// Sines found.
        found: usize,
        /// Sines whose motion stands out of the noise.
        usable: usize,
        /// Why the others cannot be used.
        left_out: Vec<LeftOut>,
    },
}

/// Largest number of tones that an error names.
const MOST: usize = 6;

/// Why tones were left out, as the end of a sentence.
fn reasons(left_out: &[LeftOut]) -> String {
    let named = left_out.iter().take(MOST).map(|tone| format!("; {tone}")).collect::<String>();
    match left_out.len().saturating_sub(MOST) {
        0 => named,
        more => format!("{named}; and {more} more"),
    }
}
