//! How far a model is from the fullest one.

use serde::Serialize;

use super::model_result::ModelResult;
use crate::quantity::significant;
use crate::simulation::Trajectory;

/// How far a model's numbers are from the fullest's, each as a share of the fullest's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// Of the device's passivity, on which the certificate rests; `None` where the fullest model
    /// has none.
    pub delta: Option<f64>,
    /// Of the stiffness at which the loop in its hand stops being stable; `None` where neither
    /// model has one, infinite where only one has.
    pub critical_stiffness: Option<f64>,
    /// Largest of the angle over the run, as a share of the largest angle; infinite where the
    /// motion of only one of the two leaves the range of numbers.
    pub angle: f64,
    /// The same of the torque.
    pub torque: f64,
}

impl Deviation {
    /// Of a model's facts from the fullest's.
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

    /// Its parts by name, those apart that are not there.
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

/// A share as people write it.
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

/// Equal numbers are equal, both zero included.
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
