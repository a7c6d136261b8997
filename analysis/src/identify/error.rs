//! Why a record identifies nothing.

use thiserror::Error;

use super::estimate::Estimate;
use super::left_out::{LEAST_PERIODS, LeftOut, grouped};
use super::turns::TurnsError;
use crate::quantity::significant;
use crate::table::TableError;

/// Why a record identifies nothing.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum IdentifyError {
    #[error(transparent)]
    Record(#[from] TableError),
    #[error(transparent)]
    Turns(#[from] TurnsError),
    #[error(
        "the counter wraps: in row {row}, at {} s, the counts jump from {from} to {to}, the range of a counter \
         of {range} counts ({jumps} such jumps in the record). Add or subtract {range} at each, or record the \
         position as a number that does not wrap",
        significant(*.time, 6)
    )]
    Wrapped { row: usize, time: f64, from: f64, to: f64, range: f64, jumps: usize },
    #[error(
        "torque and counts have opposite signs: from row {row} on, at {} Hz, Re(1/J) is {} N m s/rad, and the \
         {sines} slowest sines all turn against their torque. Change the sign of one of the two columns; on a \
         board, exchange the encoder's channels or the motor's wires",
        significant(*.frequency, 3),
        significant(*.re, 3)
    )]
    Reversed { frequency: f64, re: f64, row: usize, sines: usize },
    #[error(
        "the torque has no steady sine of at least {} periods{}",
        LEAST_PERIODS, reasons(.0)
    )]
    NoSteps(Vec<LeftOut>),
    #[error(
        "the sine of {} N m at {} Hz moved the device by a torque with {:.1} % \
         of harmonics that were not commanded: the amplifier clips there, at its limit of current or \
         of voltage, or the encoder's hysteresis is a large part of the motion. Lower the amplitude of this tone \
         and of those above it (firmware/src/bin/identify.rs), or raise the amplifier's limit; for an encoder with \
         hysteresis raise the amplitude; and measure again",
        significant(*.amplitude, 3),
        significant(*.frequency, 3),
        100.0 * .part
    )]
    Clipped { frequency: f64, amplitude: f64, part: f64 },
    #[error(
        "the sines give an inertia of {} kg m^2, from {} to {}, which is below 0: they are too slow to show it, or \
         this is no record of sines. A record of slow whole turns is read with --turns",
        significant(.0.value, 3),
        significant(.0.lo, 3),
        significant(.0.hi, 3)
    )]
    Inertia(Estimate),
    #[error(
        "{usable} of {found} sines can be used; a fit of inertia, damping, lag and delay needs at \
         least 3 at different frequencies{}", reasons(.left_out)
    )]
    TooFew { found: usize, usable: usize, left_out: Vec<LeftOut> },
}

/// Why tones were left out, as the end of a sentence: once for each reason.
fn reasons(left_out: &[LeftOut]) -> String {
    grouped(left_out).iter().map(|group| format!("; {group}")).collect()
}
