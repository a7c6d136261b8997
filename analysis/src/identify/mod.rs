//! Measures a device's damping: from a record of stepped sines to a `[device]` table (theory, section 3.3).
//!
//! ```text
//! record -> steps -> responses J(w) -> disk Re(1/J) >= delta,
//!                                      fit 1/J = (b + j w m + Z) (1 + j w tau) e^(j w d)
//! ```
//!
//! [`record`] reads a CSV file, `step` finds the stretches of steady sine in it, `response` takes one bin
//! of each, `fit` draws the conclusions, and `clipping` refuses them where the motor did not give the
//! torques. `input_check` refuses wrapped counters and reversed signs; `left_out` says which tones are not
//! used. A conclusion is a `model` of the device and of its torque's latency; `least_squares` finds
//! the nearest one for a lag, `profile` the intervals over all lags, and `latency` derives lag and delay
//! from them. [`torque_source`] is `Z`, the impedance that the current loop of a board's own bridge adds to
//! the device. [`turns`] is the same for slow whole turns: friction, cogging, and the nonlinearity of an encoder.
//! `port` records a board's measurement; [`rig`] simulates a measured device, with the errors
//! of a real measurement, and `measurement` has the emulated board measure it.

mod clipping;
mod error;
mod estimate;
mod fit;
mod input_check;
mod latency;
mod least_squares;
pub(crate) mod left_out;
pub(crate) mod measurement;
mod model;
pub(crate) mod port;
mod profile;
pub mod record;
mod response;
pub mod rig;
mod step;
pub mod torque_source;
pub mod turns;

pub use error::IdentifyError;
pub use estimate::{CONFIDENCE, Estimate};
pub use fit::{Disk, Identification};
pub use latency::{Latency, NoLatency};
pub use left_out::LeftOut;
pub use model::Model;
pub use record::Record;
pub use response::{Correction, FrequencyPoint};
pub use turns::{Linearity, SlowTurns};

/// Identifies a rigid device, or at least its passivity, from a record.
pub fn identify(record: &Record, correction: &Correction) -> Result<Identification, IdentifyError> {
    input_check::wraps(&record.counts, correction.count_angle, record.period)?;
    let (steps, mut left_out) = step::steps(record);
    if steps.is_empty() {
        return Err(IdentifyError::NoSteps(left_out));
    }
    let mut responses = Vec::new();
    for step in &steps {
        match response::single_bin(record, step, correction) {
            Ok(response) => responses.push(response),
            Err(reason) => left_out.push(LeftOut::new(step.omega, step.rows.start, reason)),
        }
    }
    input_check::polarity(&responses)?;
    let found = fit::identify(record.period, correction, steps.len(), responses, left_out)?;
    clipping::check(record, &steps, correction, &found)?;
    match found.inertia.value < 0.0 {
        true => Err(IdentifyError::Inertia(found.inertia)),
        false => Ok(found),
    }
}

/// Friction, damping and cogging of a device, from a record of slow whole turns in both directions.
pub fn slow_turns(record: &Record, correction: &Correction) -> Result<SlowTurns, IdentifyError> {
    input_check::wraps(&record.counts, correction.count_angle, record.period)?;
    Ok(turns::slow_turns(record, correction)?)
}

/// The nonlinearity of an encoder by a second one, each with its counts in a turn.
pub fn linearity(pair: &record::Pair, counts: [f64; 2]) -> Result<Linearity, IdentifyError> {
    let [count_angle, reference_angle] = counts.map(|counts| std::f64::consts::TAU / counts);
    input_check::wraps(&pair.counts, count_angle, pair.period)?;
    input_check::wraps(&pair.reference, reference_angle, pair.period)?;
    Ok(turns::linearity(pair, count_angle, reference_angle)?)
}

#[cfg(test)]
mod tests;
