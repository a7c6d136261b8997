//! What somebody or something says about a loop, and whether that is so.

use firmware::certificate::{QuantizationBound, Rejection, Resolution, assess, certify};
use firmware::number::Format;
use firmware::passivity::interval::Interval;
use firmware::scene::Scene;
use serde::Serialize;

use crate::quantity::significant;
use crate::simulation::{Experiment, Integration, SimulationError};
use crate::stability::{closed_loop, eigenvalues, radius};

/// Does it come to rest?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Says {
    /// Yes.
    Safe,
    /// No.
    Unsafe,
    /// Neither, which never means yes.
    Undecided,
}

impl Says {
    /// In one word.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Unsafe => "unsafe",
            Self::Undecided => "undecided",
        }
    }

    /// Safe or not.
    pub const fn of(is_safe: bool) -> Self {
        if is_safe { Self::Safe } else { Self::Unsafe }
    }
}

/// How a claim is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Failure {
    /// It says safe, and is not.
    Dangerous,
    /// It says unsafe, and is safe.
    Needless,
}

/// What is said about a loop, by whom, and why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// The method.
    pub by: String,
    /// Its answer.
    pub says: Says,
    /// The number that the answer rests on, if there is one: which, and in which unit, is in
    /// [`Claim::because`].
    pub figure: Option<f64>,
    /// Why, in a sentence with numbers.
    pub because: String,
}

impl Claim {
    /// A claim that rests on a number; `because` has `{}` where that number goes.
    pub fn new(by: impl Into<String>, says: Says, figure: f64, because: &str) -> Self {
        let because = because.replacen("{}", &significant(figure, 6), 1);
        Self { by: by.into(), says, figure: Some(figure), because }
    }

    /// What the eigenvalues of a loop say, as a method of integration shows them.
    ///
    /// # Errors
    /// Where there is no loop, or its eigenvalues are not found.
    pub fn eigenvalues(
        by: impl Into<String>,
        experiment: &Experiment,
        integration: Integration,
    ) -> Result<Self, SimulationError> {
        let closed = closed_loop(experiment, integration)?;
        Ok(Self::modulus(by, "largest eigenvalue", radius(&eigenvalues(&closed.matrix)?)))
    }

    /// What a modulus says that has to be inside the unit circle; `of` is what has it.
    pub fn modulus(by: impl Into<String>, of: &str, modulus: f64) -> Self {
        let (is_inside, beside) = (modulus < 1.0, significant((modulus - 1.0).abs(), 6));
        let side = if is_inside { "inside" } else { "outside" };
        Self {
            by: by.into(),
            says: Says::of(is_inside),
            figure: Some(modulus),
            because: format!("the {of} is {beside} {side} the unit circle"),
        }
    }

    /// What the certificate says about a scene: the index that it found, or its refusal.
    pub fn certificate(scene: &Scene) -> Self {
        let assessment = assess(scene);
        let index = assessment.alpha_coupled.or(assessment.alpha);
        let (says, because) = match certify(scene) {
            Ok(_) => (Says::Safe, certified(index, assessment.delta)),
            Err(rejection @ Rejection::Undecided { .. }) => {
                (Says::Undecided, rejection.to_string())
            }
            Err(rejection) => (Says::Unsafe, rejection.to_string()),
        };
        Self { by: "certificate".into(), says, figure: index.map(|alpha| alpha.hi()), because }
    }

    /// What the certificate says about a certified scene at rest, on a device with these steps and
    /// this friction, computed in a number format; the figure is the friction in N m that is enough.
    pub fn at_rest(scene: &Scene, format: Format, steps: &Resolution) -> Self {
        let rest = QuantizationBound::of(scene, format, steps);
        let says = match rest.and_then(|rest| rest.comes_to_rest()) {
            Some(comes) => Says::of(comes),
            None => Says::Undecided,
        };
        let because = rest.map_or_else(String::new, |rest| format!("certified, but {rest}"));
        Self { by: "certificate".into(), says, figure: rest.map(|rest| rest.hum()), because }
    }

    /// How it is wrong, if it is.
    pub fn failure(&self, truth: Says) -> Option<Failure> {
        match (self.says, truth) {
            (Says::Safe, Says::Unsafe) => Some(Failure::Dangerous),
            (Says::Unsafe, Says::Safe) => Some(Failure::Needless),
            _ => None,
        }
    }
}

/// What a certificate rests on, in words.
fn certified(index: Option<Interval>, delta: Interval) -> String {
    let number = |value: f64| significant(value, 6);
    let needs = index.map_or_else(String::new, |alpha| number(alpha.hi()));
    format!(
        "certified: it needs {needs} of the {} N m s/rad that the device has",
        number(delta.lo())
    )
}
