//! Faults of a record that have one cause: a counter that wraps, and a sign that is reversed.

use super::error::IdentifyError;
use super::response::FrequencyPoint;

/// Ranges of the counters of timers and encoders.
const RANGES: [f64; 5] = [4096.0, 16_384.0, 65_536.0, 16_777_216.0, 4_294_967_296.0];

/// Refuses counts that jump by the range of a counter: without these jumps no step between two rows is as large
/// as a quarter of the range. An encoder with counts of `count_angle` rad is read every `period` s.
pub fn wraps(counts: &[f64], count_angle: f64, period: f64) -> Result<(), IdentifyError> {
    let turn = (std::f64::consts::TAU / count_angle).round();
    let steps = || counts.windows(2).map(|pair| pair[1] - pair[0]);
    let most = steps().fold(0.0, |most: f64, step| most.max(step.abs()));
    let is_wrapped = |range: &f64| {
        let without = |step: f64| step - range * (step / range).round();
        most > 0.5 * range
            && most < 1.5 * range
            && steps().all(|step| without(step).abs() < 0.25 * range)
    };
    let Some(range) =
        RANGES.into_iter().chain([turn]).find(|range| *range > 8.0 && is_wrapped(range))
    else {
        return Ok(());
    };
    let jumps = || steps().enumerate().filter(|(_, step)| step.abs() > 0.5 * range);
    let row = jumps().next().map_or(0, |(row, _)| row + 1);
    Err(IdentifyError::Wrapped {
        row: row + 1,
        time: row as f64 * period,
        from: counts[row.saturating_sub(1)],
        to: counts[row],
        range,
        jumps: jumps().count(),
    })
}

/// Refuses a record in which the slower half of the sines turns against the torque.
pub fn polarity(responses: &[FrequencyPoint]) -> Result<(), IdentifyError> {
    let mut slowest: Vec<&FrequencyPoint> = responses.iter().collect();
    slowest.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    slowest.truncate(responses.len().div_ceil(2));
    // Damping and inertia have no negative part; a delay turns fast sines, and these are the slow ones.
    let against = |r: &FrequencyPoint| {
        let impedance = r.impedance();
        impedance.im < 0.0 && impedance.re < -2.0 * r.deviation
    };
    match slowest.first() {
        Some(first) if slowest.iter().all(|response| against(response)) => {
            let (frequency, re) = (first.omega / std::f64::consts::TAU, first.impedance().re);
            Err(IdentifyError::Reversed { frequency, re, row: first.row + 1, sines: slowest.len() })
        }
        _ => Ok(()),
    }
}
