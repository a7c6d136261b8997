//! The reference cases: 65 environments with indices to 34 digits (`data/vectors.json`).

use crate::exact::{Q, of_decimal};
use crate::poly::Poly;
use crate::rules::Exact;
use haptic_servo::environment::{Environment, Rational};
use haptic_servo::scene::{Coupling, Device, Scene};
use serde_json::Value;

/// A case: decimal text as it stands in the file.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name.
    pub name: String,
    /// Index of the environment alone; `None` where it does not exist.
    pub alpha: Option<Q>,
    /// Index of `E'`.
    pub alpha_coupled: Option<Q>,
    /// Whether equations 17 to 19 hold.
    pub paper: bool,
    /// Whether the exact rule holds.
    pub exact: bool,
    /// Why not, in words.
    pub reason: String,
    /// The scene in exact numbers.
    pub loop_: Exact,
    numerator: Vec<f64>,
    denominator: Vec<f64>,
    period: f64,
    delta: f64,
    coupling: Option<f64>,
}

impl Case {
    /// The scene as it would be typed into a program: every decimal as its nearest `f64`.
    ///
    /// # Panics
    /// If the environment has more coefficients than a scene can hold.
    pub fn scene(&self) -> Scene {
        let rational = Rational::of(&self.numerator, &self.denominator).expect("degree 8 at most");
        Scene {
            coupling: self
                .coupling
                .map_or(Coupling::Rigid, |stiffness| Coupling::Spring { stiffness }),
            ..Scene::of(
                Device { inertia: 2.2e-5, damping: self.delta, passivity: Some(self.delta) },
                self.period,
                Environment::Rational(rational),
            )
        }
    }

    /// Whether the index equals the limit exactly: then no answer but `pass` is wrong.
    pub fn is_on_the_line(&self) -> bool {
        self.alpha_coupled.as_ref() == Some(&self.loop_.delta)
    }
}

/// All cases.
///
/// # Panics
/// If the file beside this crate is damaged.
pub fn all() -> Vec<Case> {
    let text = include_str!("../data/vectors.json");
    let file: Vec<Value> = serde_json::from_str(text).expect("data/vectors.json is JSON");
    file.iter().map(|v| case(v).expect("data/vectors.json has the fields of a case")).collect()
}

fn case(value: &Value) -> Option<Case> {
    let text = |key: &str| value.get(key).and_then(Value::as_str);
    let list = |key: &str| -> Option<Vec<&str>> {
        value.get(key)?.as_array()?.iter().map(Value::as_str).collect()
    };
    let exact =
        |texts: &[&str]| -> Option<Vec<Q>> { texts.iter().map(|t| of_decimal(t)).collect() };
    let binary =
        |texts: &[&str]| -> Option<Vec<f64>> { texts.iter().map(|t| t.parse().ok()).collect() };
    let (numerator, denominator) = (list("E_num")?, list("E_den")?);
    Some(Case {
        name: text("name")?.to_owned(),
        alpha: text("alpha_min").and_then(of_decimal),
        alpha_coupled: text("alpha_equiv").and_then(of_decimal),
        paper: text("verdict")? == "pass",
        exact: text("verdict_exact")? == "pass",
        reason: text("reason")?.to_owned(),
        loop_: Exact {
            numerator: Poly::descending(&exact(&numerator)?),
            denominator: Poly::descending(&exact(&denominator)?),
            period: of_decimal(text("T")?)?,
            delta: of_decimal(text("delta")?)?,
            coupling: text("K_vc").and_then(of_decimal),
        },
        numerator: binary(&numerator)?,
        denominator: binary(&denominator)?,
        period: text("T")?.parse().ok()?,
        delta: text("delta")?.parse().ok()?,
        coupling: text("K_vc").and_then(|k| k.parse().ok()),
    })
}
