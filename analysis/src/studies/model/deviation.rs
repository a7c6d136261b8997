//! The deviation of a model from the fullest model.

use serde::Serialize;

use super::model_result::ModelResult;
use crate::quantity::significant;
use crate::simulation::Trajectory;

/// The relative deviations of a model's numbers from those of the fullest model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// Of the device's passivity, which the certificate uses; `None` if the fullest model has none.
    pub delta: Option<f64>,
    /// Of the critical stiffness of the loop in its hand; `None` if neither model has one, infinite if only
    /// one has.
    pub critical_stiffness: Option<f64>,
    /// Largest deviation of the angle over the run, relative to the largest angle; infinite if the motion of
    /// only one of the two leaves the range of numbers.
    pub angle: f64,
    pub torque: f64,
}

impl Deviation {
    /// The deviation of a model's result from the fullest model's.
    pub(super) fn of(result: &ModelResult, fullest: &ModelResult) -> Self {
        let delta = fullest.delta.map(|full| share(result.delta, full));
        let critical_stiffness = match (result.critical_stiffness, fullest.critical_stiffness) {
            (None, None) => None,
            (_, None) => Some(f64::INFINITY),
            (found, Some(full)) => Some(share(found, full)),
        };
        let of = |column: fn(&Trajectory) -> &[f64]| {
            largest_difference(column(&result.motion), column(&fullest.motion))
        };
        let (angle, torque) = (of(|motion| &motion.position), of(|motion| &motion.torque));
        Self { delta, critical_stiffness, angle, torque }
    }

    pub fn parts(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let parts = [
            ("delta", self.delta),
            ("critical stiffness", self.critical_stiffness),
            ("angle", Some(self.angle)),
            ("torque", Some(self.torque)),
        ];
        parts.into_iter().filter_map(|(name, part)| Some((name, part?)))
    }
}

/// A fraction in per cent.
pub fn percent(share: f64) -> String {
    if share.is_finite() { format!("{} %", significant(100.0 * share, 3)) } else { "-".to_owned() }
}

fn share(found: Option<f64>, full: f64) -> f64 {
    found.map_or(f64::INFINITY, |found| relative((found - full).abs(), full.abs()))
}

fn largest_difference(column: &[f64], full: &[f64]) -> f64 {
    if column.len() != full.len() {
        return f64::INFINITY;
    }
    let peak = full.iter().fold(0.0, |peak: f64, value| peak.max(value.abs()));
    let difference = column.iter().zip(full).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    relative(difference, peak)
}

/// Equal numbers have no deviation, including two zeros.
fn relative(difference: f64, of: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / of }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_shares_of_the_peak() {
        assert_eq!(largest_difference(&[1.0, -3.5], &[1.5, -4.0]), 0.125);
        assert_eq!(largest_difference(&[0.0], &[0.0]), 0.0);
        assert_eq!(largest_difference(&[1.0], &[0.0]), f64::INFINITY);
        assert_eq!(largest_difference(&[1.0], &[1.0, 1.0]), f64::INFINITY);
        assert_eq!((share(Some(6.0), -8.0), share(None, 1.0)), (1.75, f64::INFINITY));
        assert_eq!((percent(0.0123), percent(f64::INFINITY)), ("1.23 %".into(), "-".into()));
    }
}
