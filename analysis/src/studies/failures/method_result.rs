//! The verdict of a method on a loop, and whether it is right.

use haptic_servo::certificate::{QuantizationBound, Rejection, Resolution, assess, certify};
use haptic_servo::number::Format;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::Scene;
use haptic_servo::words;
use serde::Serialize;

use super::motion::{Motion, Outcome};
use crate::quantity::significant;
use crate::simulation::{Experiment, Integration, SimulationError};
use crate::stability::{closed_loop, eigenvalues, radius};

words! {
    /// Whether a loop comes to rest.
    #[derive(Serialize)]
    #[serde(rename_all = "lowercase")]
    MethodVerdict {
    /// Yes.
    Safe "safe",
    /// No.
    Unsafe "unsafe",
    /// Neither; never counts as safe.
    Undecided "undecided",
    }
}

impl MethodVerdict {
    /// Safe or not.
    pub const fn of(is_safe: bool) -> Self {
        if is_safe { Self::Safe } else { Self::Unsafe }
    }
}

/// The kind of a wrong verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Failure {
    /// A false positive.
    Dangerous,
    /// A false negative.
    Needless,
}

/// The verdict of a method on a loop, and its reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodResult {
    /// The method.
    #[serde(rename = "by")]
    pub method: String,
    /// Its verdict.
    #[serde(rename = "says")]
    pub verdict: MethodVerdict,
    /// The number that decides the verdict, if there is one; its meaning and unit are in
    /// [`MethodResult::reason`].
    pub figure: Option<f64>,
    /// The reason as text with numbers.
    #[serde(rename = "because")]
    pub reason: String,
}

/// The reason of a verdict by a motion.
pub const MOVES: &str = "at the end it moves to and fro by {} rad";

impl MethodResult {
    /// A verdict by a number; `reason` has `{}` in the place of the number.
    pub fn new(
        method: impl Into<String>,
        verdict: MethodVerdict,
        figure: f64,
        reason: &str,
    ) -> Self {
        let reason = reason.replacen("{}", &significant(figure, 6), 1);
        Self { method: method.into(), verdict, figure: Some(figure), reason }
    }

    /// The verdict by a motion: whether it comes to rest. The number is its last swing in rad.
    pub fn of_motion(method: impl Into<String>, motion: &Motion, reason: &str) -> Self {
        let verdict = MethodVerdict::of(motion.outcome() == Outcome::Converges);
        Self::new(method, verdict, motion.last, reason)
    }

    /// The verdict by the eigenvalues of a loop, as shown by a method of integration.
    pub fn eigenvalues(
        method: impl Into<String>,
        experiment: &Experiment,
        integration: Integration,
    ) -> Result<Self, SimulationError> {
        let closed = closed_loop(experiment, integration)?;
        Ok(Self::modulus(method, "largest eigenvalue", radius(&eigenvalues(&closed.matrix)?)))
    }

    /// The verdict by the exact eigenvalues of a scene on its device without a hand.
    pub fn in_no_hand(scene: &Scene) -> Result<Self, SimulationError> {
        let alone = Experiment::still(scene);
        Self::eigenvalues("exact exponential, in no hand", &alone, Integration::default())
    }

    /// The verdict by a number that must be less than another: the method is a bound on it.
    pub fn bound(method: impl Into<String>, value: f64, limit: f64, reason: &str) -> Self {
        Self::new(method, MethodVerdict::of(value < limit), limit, reason)
    }

    /// The verdict by a modulus that must be inside the unit circle; `of` names it.
    pub fn modulus(method: impl Into<String>, of: &str, modulus: f64) -> Self {
        let (is_inside, beside) = (modulus < 1.0, significant((modulus - 1.0).abs(), 6));
        let side = if is_inside { "inside" } else { "outside" };
        Self {
            method: method.into(),
            verdict: MethodVerdict::of(is_inside),
            figure: Some(modulus),
            reason: format!("the {of} is {beside} {side} the unit circle"),
        }
    }

    /// The verdict of the certificate on a scene: its index, or its rejection.
    pub fn certificate(scene: &Scene) -> Self {
        let assessment = assess(scene);
        let index = assessment.alpha_port.or(assessment.alpha_coupled).or(assessment.alpha);
        let (verdict, reason) = match certify(scene) {
            Ok(_) => (MethodVerdict::Safe, certified(index, assessment.delta)),
            Err(rejection @ Rejection::Undecided { .. }) => {
                (MethodVerdict::Undecided, rejection.to_string())
            }
            Err(rejection) => (MethodVerdict::Unsafe, rejection.to_string()),
        };
        Self {
            method: "certificate".into(),
            verdict,
            figure: index.map(|alpha| alpha.hi()),
            reason,
        }
    }

    /// The verdict of the certificate on a certified scene at rest, on a device with these steps and this
    /// friction, in a number format; the figure is the sufficient friction in N m.
    pub fn at_rest(scene: &Scene, format: Format, steps: &Resolution) -> Self {
        let rest = QuantizationBound::of(scene, format, steps);
        let verdict = match rest.and_then(|rest| rest.comes_to_rest()) {
            Some(comes) => MethodVerdict::of(comes),
            None => MethodVerdict::Undecided,
        };
        let reason = rest.map_or_else(String::new, |rest| format!("certified, but {rest}"));
        Self { method: "certificate".into(), verdict, figure: rest.map(|rest| rest.hum()), reason }
    }

    /// The failure, if it is wrong.
    pub fn failure(&self, truth: MethodVerdict) -> Option<Failure> {
        match (self.verdict, truth) {
            (MethodVerdict::Safe, MethodVerdict::Unsafe) => Some(Failure::Dangerous),
            (MethodVerdict::Unsafe, MethodVerdict::Safe) => Some(Failure::Needless),
            _ => None,
        }
    }
}

/// The basis of a certificate as text.
fn certified(index: Option<Interval>, delta: Interval) -> String {
    let number = |value: f64| significant(value, 6);
    let needs = index.map_or_else(String::new, |alpha| number(alpha.hi()));
    format!(
        "certified: it needs {needs} of the {} N m s/rad that the device has",
        number(delta.lo())
    )
}
