//! Why a record identifies nothing.

use thiserror::Error;

use super::left_out::{LEAST_PERIODS, LeftOut, grouped};
use crate::quantity::significant;
use crate::table::TableError;

/// Why a record identifies nothing.
#[derive(Debug, Error)]
pub enum IdentifyError {
    /// The file.
    #[error(transparent)]
    Record(#[from] TableError),
    /// The counter wrapped.
    #[error(
        "the counter wraps: in row {row}, at {} s, the counts jump from {from} to {to}, the range of a counter \
         of {range} counts ({jumps} such jumps in the record). Add or subtract {range} at each, or record the \
         position as a number that does not wrap",
        significant(*.time, 6)
    )]
    Wrapped {
        /// The row with the first jump, counted from 1.
        row: usize,
        /// Its time after the first row in s.
        time: f64,
        /// Counts before the jump.
        from: f64,
        /// Counts after it.
        to: f64,
        /// The counter's range.
        range: f64,
        /// Number of jumps.
        jumps: usize,
    },
    /// Torque and motion have opposite signs.
    #[error(
        "torque and counts have opposite signs: from row {row} on, at {} Hz, Re(1/J) is {} N m s/rad, and the \
         {sines} slowest sines all turn against their torque. Change the sign of one of the two columns; on a \
         board, exchange the encoder's channels or the motor's wires",
        significant(*.frequency, 3),
        significant(*.re, 3)
    )]
    Reversed {
        /// Frequency of the slowest sine in Hz.
        frequency: f64,
        /// Real part of `1/J` there in N m s/rad.
        re: f64,
        /// Its first row, counted from 1.
        row: usize,
        /// Number of sines.
        sines: usize,
    },
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

/// Why tones were left out, as the end of a sentence: once for each reason.
fn reasons(left_out: &[LeftOut]) -> String {
    grouped(left_out).iter().map(|group| format!("; {group}")).collect()
}
