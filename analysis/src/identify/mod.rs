//! What a device's damping measures: from a record of stepped sines to a `[device]` table
//! (theory, section 3.3).
//!
//! ```text
//! record -> steps -> responses J(w) -> disk Re(1/J) >= delta, and fit 1/J = (b + j w m) e^(j w t0)
//! ```
//!
//! [`record`] reads a CSV file, [`step`] finds the stretches of steady sine in it, [`response`]
//! takes one bin of each, [`fit`] draws the conclusions, and [`clipping`] refuses them where the motor
//! did not give the torques. [`port`] records what a board measures; [`rig`] simulates a device that is
//! measured so, with all that spoils a measurement, and [`measurement`] has the emulated board measure
//! it.

pub mod clipping;
pub mod fit;
pub mod measurement;
pub mod port;
pub mod record;
pub mod response;
pub mod rig;
pub mod step;

use thiserror::Error;

use crate::quantity::significant;
use crate::table::TableError;

pub use fit::{Disk, Estimate, Identification};
pub use record::Record;
pub use response::{Correction, Response};
pub use step::LeftOut;

/// Why a record identifies nothing.
#[derive(Debug, Error)]
pub enum IdentifyError {
    /// The file.
    #[error(transparent)]
    Record(#[from] TableError),
    /// No stretch of steady sine.
    #[error(
        "there is no stretch of at least {} periods of a steady sine in the torque{}",
        step::LEAST_PERIODS, reasons(.0)
    )]
    NoSteps(Vec<LeftOut>),
    /// The device felt another torque than the record says.
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
        "{usable} of {found} sines can be used; a fit of inertia, damping and skew needs at least \
         3 at different frequencies{}", reasons(.left_out)
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

/// Most tones that an error names.
const MOST: usize = 6;

/// Why tones were left out, as the end of a sentence.
fn reasons(left_out: &[LeftOut]) -> String {
    let named = left_out.iter().take(MOST).map(|tone| format!("; {tone}")).collect::<String>();
    match left_out.len().saturating_sub(MOST) {
        0 => named,
        more => format!("{named}; and {more} more"),
    }
}

/// Identifies a rigid device, or at least its passivity, from a record.
pub fn identify(record: &Record, correction: &Correction) -> Result<Identification, IdentifyError> {
    let (steps, mut left_out) = step::steps(record);
    if steps.is_empty() {
        return Err(IdentifyError::NoSteps(left_out));
    }
    let mut responses = Vec::new();
    for step in &steps {
        match response::single_bin(record, step, correction) {
            Some(response) => responses.push(response),
            None => left_out.push(LeftOut::new(step.omega, "it has no torque, or nothing moves")),
        }
    }
    let found = fit::identify(record.period, steps.len(), responses, left_out)?;
    clipping::check(record, &steps, correction, &found)?;
    Ok(found)
}

#[cfg(test)]
mod tests;
