//! What the certificate says about a scene, as the fields that people and programs read.

use firmware::certificate::{Answer, Assessment, Rejection, assess};
use firmware::scene::Scene;
use serde::Serialize;

/// The answer to "is this scene safe".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Proved passive: safe in every hand.
    Certified,
    /// Proved not to satisfy the rule.
    Rejected,
    /// Neither; never means yes.
    Undecided,
}

/// The answer of one rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RuleAnswer {
    /// Proved.
    Pass,
    /// Disproved.
    Fail,
    /// Neither.
    Undecided,
}

/// Both rules' answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rules {
    /// Equations 17 to 19 (theory, section 4).
    pub paper: RuleAnswer,
    /// The exact rule (theory, section 4.1).
    pub exact: RuleAnswer,
}

/// An enclosure in N m s/rad; both ends are `None` where the value does not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Enclosure {
    /// Lower end.
    pub lo: Option<f64>,
    /// Upper end.
    pub hi: Option<f64>,
}

/// A judged scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// What the person calls the scene.
    pub name: String,
    /// The answer.
    pub verdict: Verdict,
    /// What each rule says.
    pub rules: Rules,
    /// `ok`, or the code of the reason.
    pub reason: &'static str,
    /// Index of the environment alone.
    pub alpha: Enclosure,
    /// Index of `E'` (theory, section 4.1).
    pub alpha_coupled: Enclosure,
    /// Passivity of the device in N m s/rad, scaled to the worst period.
    pub delta: f64,
    /// `delta` less the upper end of the index that decided, in N m s/rad: how much is to spare.
    pub margin: Option<f64>,
    /// Angle on the unit circle in rad where the deciding index is reached; 0 is rest, pi the
    /// Nyquist frequency.
    pub theta: Option<f64>,
    /// What the verdict rests on.
    pub assumptions: Vec<String>,
    /// The answer as a sentence.
    pub message: String,
    /// Changes of one number each that would make a rejected scene pass.
    pub remedies: Vec<String>,
}

/// Judges a scene that the person calls `name`.
pub fn judge(name: &str, scene: &Scene) -> Report {
    let assessment = assess(scene);
    let rejection = assessment.outcome.err();
    let reason = rejection.as_ref().map_or("ok", reason);
    let verdict = match rejection {
        None => Verdict::Certified,
        Some(_) if reason == "undecided" => Verdict::Undecided,
        Some(_) => Verdict::Rejected,
    };
    let delta = assessment.delta.lo();
    let margin = deciding(&assessment).map(|alpha| delta - alpha.hi());
    let mut report = Report {
        name: name.to_owned(),
        verdict,
        rules: Rules { paper: answer(assessment.paper), exact: answer(assessment.exact) },
        reason,
        alpha: enclosure(assessment.alpha),
        alpha_coupled: enclosure(assessment.alpha_coupled),
        delta,
        margin,
        theta: assessment.cos_theta.map(angle),
        assumptions: Vec::new(),
        message: String::new(),
        remedies: Vec::new(),
    };
    report.message =
        rejection.map_or_else(|| passed(&report), |rejection| format!("{rejection:?}"));
    report
}

type Interval = firmware::passivity::interval::Interval;

/// The index that the verdict compares with delta: the nonlinear bound where the scene has one,
/// otherwise that of `E'`.
fn deciding(assessment: &Assessment) -> Option<Interval> {
    assessment.bound.or(assessment.alpha_coupled)
}

fn passed(report: &Report) -> String {
    match report.margin {
        Some(margin) => format!(
            "certified: no passive hand can make it oscillate; {margin:.6} N m s/rad of the \
             device's {:.6} are to spare",
            report.delta
        ),
        None => "certified: no passive hand can make it oscillate".to_owned(),
    }
}

fn answer(answer: Answer) -> RuleAnswer {
    match answer {
        Answer::Pass => RuleAnswer::Pass,
        Answer::Fail => RuleAnswer::Fail,
        Answer::Undecided => RuleAnswer::Undecided,
    }
}

fn enclosure(interval: Option<Interval>) -> Enclosure {
    Enclosure { lo: interval.map(Interval::lo), hi: interval.map(Interval::hi) }
}

/// The angle in the middle of an enclosure of its cosine.
fn angle(cosine: Interval) -> f64 {
    (0.5 * (cosine.lo() + cosine.hi())).clamp(-1.0, 1.0).acos()
}

fn reason(rejection: &Rejection) -> &'static str {
    rejection.reason()
}
