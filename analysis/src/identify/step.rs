//! Stretches of steady sine in a record.

use std::ops::Range;

use super::record::Record;

/// Fewest periods of a stretch.
pub const LEAST_PERIODS: usize = 4;

/// How far the length of one period may be from the one before, relatively, in the same stretch.
const STEADY: f64 = 0.05;

/// Rows of a period below which the interpolation of a crossing is worse than that part of it.
const SHORT: f64 = 4.0;

/// A stretch in which the torque is a sine of one frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Rows of the record.
    pub rows: Range<usize>,
    /// Angular frequency in rad/s.
    pub omega: f64,
}

/// The stretches of a record: as its column `frequency` says, or else where the torque crosses
/// zero at steady intervals.
pub fn steps(record: &Record) -> Vec<Step> {
    let steps = match &record.frequency {
        Some(frequency) => labelled(frequency),
        None => crossings(record),
    };
    let is_long = |step: &Step| {
        let periods = step.omega * record.period * step.rows.len() as f64 / std::f64::consts::TAU;
        // Above half the sampling rate a sine looks like a slower one.
        periods >= LEAST_PERIODS as f64 && step.omega * record.period < std::f64::consts::PI
    };
    steps.into_iter().filter(is_long).collect()
}

fn labelled(frequency: &[f64]) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut start = 0;
    for run in frequency.chunk_by(|a, b| a == b) {
        let rows = start..start + run.len();
        start = rows.end;
        if run[0] > 0.0 {
            steps.push(Step { rows, omega: std::f64::consts::TAU * run[0] });
        }
    }
    steps
}

/// By the rising zero crossings of the torque, interpolated between samples. The frequency's error
/// turns the phases of torque and motion by the same amount, and so does no harm.
fn crossings(record: &Record) -> Vec<Step> {
    let rising =
        record.torque.windows(2).enumerate().filter(|(_, pair)| pair[0] <= 0.0 && pair[1] > 0.0);
    let times: Vec<f64> =
        rising.map(|(row, pair)| row as f64 - pair[0] / (pair[1] - pair[0])).collect();
    let mut steps = Vec::new();
    let mut first = 0;
    for last in 1..times.len() {
        let length = times[last] - times[last - 1];
        let next = times.get(last + 1).map(|next| next - times[last]);
        let goes_on = next.is_some_and(|next| (next - length).abs() <= STEADY * length.max(SHORT));
        if goes_on {
            continue;
        }
        if last > first + 1 {
            let period = (times[last] - times[first]) / (last - first) as f64;
            let rows = times[first].ceil() as usize..times[last].ceil() as usize;
            steps.push(Step { rows, omega: std::f64::consts::TAU / (period * record.period) });
        }
        first = last;
    }
    steps
}
