//! Remedies that hold for more than the certificate: for a board, with its limits and its reading time.

use haptic_servo::certificate::{Remedies, Remedy};
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::Scene;

use crate::quantity::rounded;

/// Octaves in which a value is searched.
const OCTAVES: i32 = 10;
/// Halvings of the last octave, to less than three digits.
const HALVINGS: u32 = 12;
/// Digits of a remedy, and how many values are tried from the nearest on.
const DIGITS: usize = 3;
const CANDIDATES: usize = 3;

/// A certified scene that a board rejects may pass with one of these changed: those with more of the last, and
/// less of the others.
const SEARCHED: [Parameter; 8] = [
    Parameter::Stiffness,
    Parameter::Damping,
    Parameter::ProfileTorque,
    Parameter::TorqueLimit,
    Parameter::CouplingStiffness,
    Parameter::Period,
    Parameter::DeviceDamping,
    Parameter::Passivity,
];

/// A scene and the check that a changed one has to pass.
pub struct RemedySearch<'a, P> {
    /// The scene.
    pub scene: &'a Scene,
    /// Whether the scene passes with another value of a number.
    pub passes: P,
}

impl<P: Fn(Parameter, f64) -> bool> RemedySearch<'_, P> {
    /// The remedies of a rejection, as far as the scene passes with them, and otherwise with the nearest value
    /// behind them with which it does.
    pub fn behind(&self, found: &Remedies) -> Vec<Remedy> {
        let behind = |remedy: Remedy| {
            let is_above =
                |highest: f64| self.scene.get(remedy.parameter).is_none_or(|it| it > highest);
            let (value, grows) = match (remedy.lowest, remedy.highest) {
                (_, Some(highest)) if is_above(highest) => (highest, false),
                (Some(lowest), _) => (lowest, true),
                (None, highest) => (highest?, false),
            };
            if (self.passes)(remedy.parameter, value) {
                return Some(remedy);
            }
            let value = self.nearest(remedy.parameter, value, grows)?;
            let is_in = remedy.lowest.is_none_or(|lowest| lowest <= value)
                && remedy.highest.is_none_or(|highest| value <= highest);
            is_in.then(|| exactly(remedy.parameter, value))
        };
        found.iter().filter_map(behind).collect()
    }

    /// Changes of one number with which a certified scene passes.
    pub fn searched(&self) -> Vec<Remedy> {
        let declared = self.scene.device.passivity.is_some();
        let changed = |&parameter: &Parameter| {
            let grows = match parameter {
                Parameter::DeviceDamping if declared => return None,
                Parameter::DeviceDamping | Parameter::Passivity => true,
                _ => false,
            };
            let present = self.scene.get(parameter).filter(|&value| value > 0.0)?;
            Some(exactly(parameter, self.nearest(parameter, present, grows)?))
        };
        SEARCHED.iter().filter_map(changed).collect()
    }

    /// The value of three digits, nearest to a failing one, with which the scene passes.
    fn nearest(&self, parameter: Parameter, fails: f64, grows: bool) -> Option<f64> {
        if parameter == Parameter::Count {
            return None;
        }
        let octave = |n: i32| fails * 2.0_f64.powi(if grows { n } else { -n });
        let first = (1..=OCTAVES).find(|&n| (self.passes)(parameter, octave(n)))?;
        let (mut fails, mut passes) = (octave(first - 1), octave(first));
        for _ in 0..HALVINGS {
            let middle = (fails * passes).sqrt();
            if (self.passes)(parameter, middle) { passes = middle } else { fails = middle }
        }
        let unit = 10.0_f64.powi(passes.log10().floor() as i32 + 1 - DIGITS as i32);
        let step = if grows { unit } else { -unit };
        let nearest = rounded(passes, DIGITS);
        let mut tried = (0..CANDIDATES).map(|n| rounded(nearest + n as f64 * step, DIGITS));
        tried.find(|&value| (self.passes)(parameter, value))
    }
}

fn exactly(parameter: Parameter, value: f64) -> Remedy {
    Remedy { parameter, lowest: Some(value), highest: Some(value) }
}

/// Remedies as the end of a sentence, as [`Rejection::sentence`] has them; `matched` are the words for the
/// matched coupling.
///
/// [`Rejection::sentence`]: haptic_servo::certificate::Rejection::sentence
pub fn would_pass(matched: Option<&str>, remedies: &[Remedy]) -> String {
    let numbers = remedies.iter().map(ToString::to_string).collect::<Vec<_>>().join(", or ");
    match (matched, numbers.as_str()) {
        (None, "") => String::new(),
        (None, numbers) => format!("; it would pass with {numbers}"),
        (Some(matched), "") => format!("; it would pass {matched}"),
        (Some(matched), numbers) => format!("; it would pass {matched}, or with {numbers}"),
    }
}
