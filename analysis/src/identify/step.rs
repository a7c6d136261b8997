//! Stretches of steady sine in a record.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::left_out::{LEAST_PERIODS, LeftOut, Reason};
use super::record::Record;

/// Largest relative change of the length from one period to the next in the same stretch.
const STEADY: f64 = 0.05;

/// Rows of a period below which the interpolation of a crossing is worse than that part of it.
const SHORT: f64 = 4.0;

/// A stretch in which the torque is a sine of one frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub rows: Range<usize>,
    /// Angular frequency in rad/s.
    pub omega: f64,
}

impl Step {
    /// Its rows without this part of them at the beginning, in which the transient dies out.
    pub(super) fn settled(&self, part: f64) -> Range<usize> {
        self.rows.start + (part * self.rows.len() as f64) as usize..self.rows.end
    }
}

/// The stretches of a record, as its column `frequency` states, or else where the torque crosses zero at
/// steady intervals; and the stretches that cannot be used, with the reason.
pub fn steps(record: &Record) -> (Vec<Step>, Vec<LeftOut>) {
    let (steps, mut left_out) = match &record.frequency {
        Some(frequency) => (labelled(frequency), Vec::new()),
        None => crossings(record),
    };
    let mut used = Vec::new();
    for step in steps.iter().flat_map(|step| split(step, record)) {
        match why_not(&step, record.period) {
            None => used.push(step),
            Some(reason) => left_out.push(LeftOut::new(step.omega, step.rows.start, reason)),
        }
    }
    (used, left_out)
}

/// Why a stretch cannot be used, if it cannot.
fn why_not(step: &Step, period: f64) -> Option<Reason> {
    let periods = step.omega * period * step.rows.len() as f64 / TAU;
    // Above half the sampling rate a sine looks like a slower one.
    if step.omega * period >= PI {
        return Some(Reason::Aliased { half_rate: 0.5 / period });
    }
    (periods < LEAST_PERIODS as f64).then_some(Reason::FewPeriods(periods))
}

/// Rows of a block in which an amplitude is taken, and at least one period.
const BLOCK: f64 = 16.0;

/// Largest relative change of the amplitude in the same stretch.
const SAME_AMPLITUDE: f64 = 0.1;

/// The parts of a stretch with the same amplitude: a record may have the same frequency at one amplitude after
/// the other. A block in which the amplitude changes belongs to none.
fn split(step: &Step, record: &Record) -> Vec<Step> {
    let period = TAU / (step.omega * record.period);
    let length = ((BLOCK / period).ceil().max(1.0) * period).round() as usize;
    let blocks: Vec<Range<usize>> = (0..step.rows.len() / length.max(1))
        .map(|block| step.rows.start + block * length..step.rows.start + (block + 1) * length)
        .collect();
    let amplitude = |rows: &Range<usize>| {
        let squares: f64 = record.torque[rows.clone()].iter().map(|torque| torque * torque).sum();
        (2.0 * squares / rows.len() as f64).sqrt()
    };
    let is_same = |a: &Range<usize>, b: &Range<usize>| {
        let (a, b) = (amplitude(a), amplitude(b));
        (a - b).abs() <= SAME_AMPLITUDE * a.max(b)
    };
    let parts: Vec<&[Range<usize>]> = blocks.chunk_by(is_same).collect();
    if parts.len() < 2 {
        return vec![step.clone()];
    }
    let long = parts.into_iter().filter(|part| part.len() > 1);
    long.map(|part| Step { rows: part[0].start..part[part.len() - 1].end, ..step.clone() })
        .collect()
}

fn labelled(frequency: &[f64]) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut start = 0;
    for run in frequency.chunk_by(|a, b| a == b) {
        let rows = start..start + run.len();
        start = rows.end;
        if run[0] > 0.0 {
            steps.push(Step { rows, omega: TAU * run[0] });
        }
    }
    steps
}

/// The stretches by the rising zero crossings of the torque, interpolated between samples. The frequency's
/// error turns the phases of torque and motion by the same amount, and so does no harm.
///
/// A stretch whose frequency changes slowly is a sweep, of which no part is a steady sine.
fn crossings(record: &Record) -> (Vec<Step>, Vec<LeftOut>) {
    let rising =
        record.torque.windows(2).enumerate().filter(|(_, pair)| pair[0] <= 0.0 && pair[1] > 0.0);
    let times: Vec<f64> =
        rising.map(|(row, pair)| row as f64 - pair[0] / (pair[1] - pair[0])).collect();
    let (mut steps, mut sweeps) = (Vec::new(), Vec::new());
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
            let step = Step { rows, omega: TAU / (period * record.period) };
            match sweep(&times[first..=last]) {
                Some(ratio) => {
                    sweeps.push(LeftOut::new(step.omega, step.rows.start, Reason::Sweep(ratio)))
                }
                None => steps.push(step),
            }
        }
        first = last;
    }
    (steps, sweeps)
}

/// The factor by which the frequency changes from the first half of a stretch's crossings to the second, if
/// it changes.
fn sweep(times: &[f64]) -> Option<f64> {
    let middle = times.len() / 2;
    let mean = |times: &[f64]| Some((times.last()? - times.first()?) / (times.len() - 1) as f64);
    let (before, after) = (mean(&times[..=middle])?, mean(&times[middle..])?);
    let is_steady = (after - before).abs() <= STEADY * before.max(SHORT);
    (!is_steady).then_some(before / after)
}
