//! The verdict on a scene, as the fields that people and programs read.

use std::fmt;

use haptic_servo::certificate::{
    Assessment, Assumption, AssumptionStatus, Assumptions, LoopTransfers, QuantizationBound,
    Rejection, Remedy, Resolution, Rule, RuleAnswer, assess_in, certify_in,
};
use haptic_servo::host::{HostError, HostTorque};
use haptic_servo::number::Format;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::{Coupling, EncoderReading, Latency, Scene};
use haptic_servo::servo::OutputTiming;
use haptic_servo::text::RoundUp3;
use serde::{Serialize, Serializer};

use crate::beside_host;
use crate::felt;
use crate::file::bridge::MotorOnBridge;
use crate::file::{self, SceneFile};
use crate::line_search::minimizing_angle;
use crate::on_board;
use crate::quantity::significant;
use crate::regeneration::{self, SupplyReport};
use crate::remedy_search::{RemedySearch, would_pass};
use crate::response::Response;

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

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{self:?}").to_lowercase())
    }
}

/// Both rules' answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rules {
    /// Equations 17 to 19 (theory, section 4).
    #[serde(serialize_with = "in_a_word")]
    pub paper: RuleAnswer,
    /// The exact rule (theory, section 4.1).
    #[serde(serialize_with = "in_a_word")]
    pub exact: RuleAnswer,
}

fn in_a_word<S: Serializer>(answer: &RuleAnswer, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&format!("{answer:?}").to_lowercase())
}

/// An enclosure in N m s/rad; both ends are `None` where the value does not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Enclosure {
    /// Lower end.
    pub lo: Option<f64>,
    /// Upper end.
    pub hi: Option<f64>,
}

/// Torque errors at rest by encoder, numbers and DAC, in N m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AtRest {
    /// Bound for the encoder's step; `None`: not stated.
    pub encoder: Option<f64>,
    /// Bound for the rounding of numbers.
    pub numbers: f64,
    /// Bound for the DAC's step; `None`: not stated.
    pub converter: Option<f64>,
    /// Bound for the steps of a current loop; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub current: Option<f64>,
    /// The addition where the torque changes its sign; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossing: Option<f64>,
    /// The sum: bound on the torque's error.
    pub hum: f64,
    /// Friction that prevents a limit cycle: the sum, and the mean torque of what repeats in every turn.
    pub friction_for_rest: f64,
    /// Declared friction of the device; `None`: not stated.
    pub friction: Option<f64>,
    /// Whether that is enough; `None` where it cannot be said.
    pub comes_to_rest: Option<bool>,
    /// Whether the steps cause no more than that in any motion. Otherwise they cause more in a motion through
    /// a face.
    pub in_any_motion: bool,
}

impl AtRest {
    /// Of the certificate's bound.
    pub fn of(rest: &QuantizationBound) -> Self {
        Self {
            encoder: rest.encoder,
            numbers: rest.numbers,
            converter: rest.converter,
            current: rest.current,
            crossing: rest.crossing,
            hum: rest.hum(),
            friction_for_rest: rest.for_rest(),
            friction: rest.friction,
            comes_to_rest: rest.comes_to_rest(),
            in_any_motion: rest.in_any_motion,
        }
    }
}

/// A judged scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerdictReport {
    /// Name of the scene.
    pub name: String,
    /// The answer.
    pub verdict: Verdict,
    /// The answer of each rule.
    pub rules: Rules,
    /// `ok`, or the code of the reason.
    pub reason: &'static str,
    /// Index of the environment alone.
    pub alpha: Enclosure,
    /// Index of `E'` (theory, section 4.1).
    pub alpha_coupled: Enclosure,
    /// Index at the device's port with delay, lag and sensor (theory, section 13): only of a scene that
    /// has them, or a matched coupling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha_port: Option<Enclosure>,
    /// The bound that decided in place of the linear index: one-sided and limited scenes only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<Enclosure>,
    /// Passivity of the device in N m s/rad, scaled to the worst period; the certificate compares
    /// with the lower end of an enclosure of it.
    pub delta: f64,
    /// Damping in N m s/rad that the device may lose with everything else unchanged; negative: the damping
    /// that it lacks. `None`, too, where none is known: where torques lag and a bound decides behind a
    /// coupling.
    pub margin: Option<f64>,
    /// The answer with the limits and the reading time of a board; `None` if no board has the times of a
    /// certified scene.
    pub on_board: Option<Verdict>,
    /// Stiffness in N m/rad at the handle, environment and coupling in series, at its stiffest: see
    /// [`felt::stiffness`].
    pub felt_stiffness: Option<f64>,
    /// Damping in N m s/rad that is felt outside of the wall: see [`felt::free_damping`].
    pub free_damping: Option<f64>,
    /// The margin where the torque is limited as on a board, so that a bound decides for every scene; `None`
    /// where none is known, or no board renders the scene.
    #[serde(skip)]
    pub margin_on_board: Option<f64>,
    /// Whether a board may render the scene, which then has a margin on a board, known or not.
    #[serde(skip)]
    is_rendered: bool,
    /// Angle on the unit circle in rad where the deciding index is reached; 0 is rest, pi the
    /// Nyquist frequency.
    pub theta: Option<f64>,
    /// Number format of the coefficients that were judged; `None`: as they were written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<String>,
    /// The errors from steps at rest, where the scene is certified and the steps were stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<AtRest>,
    /// Why no board renders a scene that is certified; `None` where one does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub board: Option<String>,
    /// What a host may do; only of a file that has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub host: Option<String>,
    /// Whether the bridge's supply stays below its fault level; only of a file that states a supply.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supply: Option<SupplyReport>,
    /// The assumptions of the verdict.
    pub assumptions: Vec<String>,
    /// The assumptions that do not hold, and numbers that no device has.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The one of the assumptions about a device with friction, where the scene is not certified.
    #[serde(skip)]
    pub friction: Option<String>,
    /// The answer as a sentence.
    pub message: String,
    /// The same without margin and remedies.
    #[serde(skip)]
    pub summary: String,
    /// Whether the scene states facts of a board, so that it has to pass on a board.
    #[serde(skip)]
    pub is_for_a_board: bool,
    /// Changes of one number each that would make a rejected scene pass: on a board, if it states facts of one.
    pub remedies: Vec<String>,
    /// Those that change a number.
    #[serde(skip)]
    pub changes: Vec<Remedy>,
    /// The first of them in words, if it is the matched coupling.
    #[serde(skip)]
    pub matched: Option<&'static str>,
    /// The sentence in place of remedies, if a number is too large or too small and no other is enough alone.
    #[serde(skip)]
    pub no_remedy: Option<&'static str>,
}

/// Judges a scene as it was written; nothing more is known of the machine.
pub fn judge(name: &str, scene: &Scene) -> VerdictReport {
    judge_in(name, scene, Format::F64, &Resolution::default())
}

/// Judges the coefficients of a scene as a number format rounds them, and its assumptions by the known
/// properties of the machine.
pub fn judge_in(name: &str, scene: &Scene, format: Format, steps: &Resolution) -> VerdictReport {
    let (assessment, rejection) = match certify_in(scene, format) {
        // The verdict leaves the index at the port out.
        Ok(_) if has_port_index(scene) => (assess_in(scene, format), None),
        Ok(assessment) => (assessment, None),
        Err(rejection) => (assess_in(scene, format), Some(rejection)),
    };
    reported(name, scene, format, steps, &assessment, rejection, true)
}

/// Judges the scene of a file as a number format rounds its coefficients, and the supply that the file states.
pub fn judge_file(file: &SceneFile, format: Format) -> VerdictReport {
    let bridge = file.own_bridge();
    judge_in(&file.name, &file.scene, format, &file.steps_on(&bridge)).with_facts_of(file, bridge)
}

/// The same as the file is written, [without remedies](judge_without_remedies).
pub fn judge_file_without_remedies(file: &SceneFile) -> VerdictReport {
    let bridge = file.own_bridge();
    let report = judge_without_remedies(&file.name, &file.scene, &file.steps_on(&bridge));
    report.with_facts_of(file, bridge)
}

/// A scene as it was written, without the search for remedies, which takes many times as long where times are
/// known to lie in ranges.
pub fn judge_without_remedies(name: &str, scene: &Scene, steps: &Resolution) -> VerdictReport {
    let assessment = assess_in(scene, Format::F64);
    reported(name, scene, Format::F64, steps, &assessment, assessment.outcome.err(), false)
}

fn reported(
    name: &str,
    scene: &Scene,
    format: Format,
    steps: &Resolution,
    assessment: &Assessment,
    rejection: Option<Rejection>,
    has_remedies: bool,
) -> VerdictReport {
    let verdict = match &rejection {
        None => Verdict::Certified,
        Some(rejection) if rejection.is_undecided() => Verdict::Undecided,
        Some(_) => Verdict::Rejected,
    };
    let delta = assessment.delta.midpoint();
    let margin = assessment.margin(scene);
    let margin_on_board = assessment.outcome.ok().and_then(|()| assessment.margin_on_board(scene));
    let is_rendered = assessment.outcome.is_ok()
        && assessment.renders_at(scene, OutputTiming::Simultaneous).is_ok();
    let assumptions = Assumptions::of(scene, assessment, steps);
    let failing = assumptions.iter().filter(|one| one.standing() == AssumptionStatus::Fails);
    let refusal =
        assessment.outcome.ok().and_then(|()| on_board::check(scene, assessment, steps).err());
    let is_for_a_board = scene.torque_limit.or(steps.encoder).or(steps.full_scale).is_some();
    let passes = |scene: &Scene| on_board::passes(scene, format, steps);
    let search = RemedySearch {
        scene,
        passes: |parameter, value| scene.with(parameter, value).is_some_and(|it| passes(&it)),
    };
    let (matched, changes) = match rejection.map(|rejection| rejection.remedies()) {
        _ if !has_remedies => (None, Vec::new()),
        Some(found) if is_for_a_board => {
            let matched = Scene { coupling: Coupling::Matched, ..*scene };
            (found.matched().filter(|_| passes(&matched)), search.behind(&found))
        }
        Some(found) => (found.matched(), found.iter().collect()),
        None if is_for_a_board && refusal.as_ref().is_some_and(|it| it.is_rejection) => {
            (None, search.searched())
        }
        None => (None, Vec::new()),
    };
    let friction = rejection.filter(|_| has_remedies).and_then(|rejection| match is_for_a_board {
        true => enough_friction(scene, &rejection, passes),
        false => enough_friction(scene, &rejection, |scene| certify_in(scene, format).is_ok()),
    });
    let is_judged = match &rejection {
        Some(rejection) => is_shortage(rejection),
        None => is_for_a_board && refusal.as_ref().is_some_and(|it| it.is_rejection),
    };
    let has_none = has_remedies && matched.is_none() && changes.is_empty();
    let no_remedy = (is_judged && has_none).then(|| no_remedy(scene));
    let would_pass = match no_remedy {
        Some(no_remedy) => format!("; {no_remedy}"),
        None => would_pass(matched, &changes),
    };
    let (summary, message) = match (&rejection, &refusal) {
        (None, Some(refusal)) if is_for_a_board => {
            let summary = on_board::rejected(&refusal.sentence);
            (summary.clone(), summary + &would_pass)
        }
        (None, _) => {
            let message = passed(margin, assumptions.rest());
            (CERTIFIED.to_owned(), format!("certified: {CERTIFIED}{message}"))
        }
        (Some(rejection), _) => {
            let has_own = is_for_a_board || no_remedy.is_some();
            of_rejection(rejection, format, has_own, &would_pass)
        }
    };
    VerdictReport {
        name: name.to_owned(),
        verdict,
        rules: Rules { paper: assessment.paper, exact: assessment.exact },
        reason: rejection.as_ref().map_or("ok", |rejection| rejection.reason()),
        alpha: enclosure(assessment.alpha),
        alpha_coupled: enclosure(assessment.alpha_coupled),
        alpha_port: has_port_index(scene).then(|| enclosure(assessment.alpha_port)),
        bound: assessment.bound.map(|bound| enclosure(Some(bound))),
        on_board: match (verdict, &refusal) {
            (Verdict::Certified, None) => Some(Verdict::Certified),
            (Verdict::Certified, Some(refusal)) if !refusal.is_rejection => None,
            _ => Some(Verdict::Rejected),
        },
        felt_stiffness: felt::stiffness(scene),
        free_damping: felt::free_damping(scene),
        delta,
        margin,
        margin_on_board,
        is_rendered,
        theta: minimum_angle(scene, assessment),
        format: (format != Format::F64).then(|| format.to_string()),
        rest: assumptions.rest().map(AtRest::of),
        board: refusal.map(|refusal| refusal.sentence),
        host: None,
        supply: None,
        warnings: failing.map(ToString::to_string).collect(),
        assumptions: assumptions.iter().map(ToString::to_string).collect(),
        friction: assumptions
            .iter()
            .find(|one| matches!(one, Assumption::FrictionOnly { .. }))
            .map(ToString::to_string),
        message,
        summary,
        is_for_a_board,
        remedies: matched
            .map(ToOwned::to_owned)
            .into_iter()
            .chain(changes.iter().map(ToString::to_string))
            .chain(friction)
            .collect(),
        changes,
        matched,
        no_remedy,
    }
}

/// The friction that is enough against a mean torque, if the scene passes with it. It is a number of the device, and no
/// parameter of a scene.
fn enough_friction(
    scene: &Scene,
    rejection: &Rejection,
    passes: impl Fn(&Scene) -> bool,
) -> Option<String> {
    let Rejection::MotorByInl { mean, .. } = rejection else { return None };
    // A scene refers to it, as to the table of a torque profile.
    let encoder = EncoderReading { friction: mean.hi(), ..*scene.latency.encoder };
    let latency = Latency { encoder: Box::leak(Box::new(encoder)), ..scene.latency };
    passes(&Scene { latency, ..*scene })
        .then(|| format!("device friction >= {} N m", RoundUp3(mean.hi())))
}

/// Whether a rejection is of a number that is too large or too small.
fn is_shortage(rejection: &Rejection) -> bool {
    matches!(
        rejection,
        Rejection::Shortage { .. }
            | Rejection::Missed { .. }
            | Rejection::Coupling { .. }
            | Rejection::Steep { .. }
            | Rejection::UnstablePole { behind_standard: None, .. }
    )
}

/// In place of remedies where two numbers or more have to change.
fn no_remedy(scene: &Scene) -> &'static str {
    match scene.environment.wall() {
        Some(_) => {
            "no change of one number by up to a factor of 64 was found to be enough; `haptic design stiffest` searches \
             coupling, rate and wall together"
        }
        None => "no change of one number by up to a factor of 64 was found to be enough",
    }
}

/// The reason of a rejection, and the same with what would pass: as `would_pass` says if it is not that of the
/// certificate itself, such as on a board.
fn of_rejection(
    rejection: &Rejection,
    format: Format,
    has_own: bool,
    would_pass: &str,
) -> (String, String) {
    let reason = rejection.reason_in(format).as_str().to_owned();
    let sentence = rejection.sentence_in(format).as_str().to_owned();
    // The remedies do not have those of two numbers.
    if !has_own && !sentence.ends_with(would_pass) {
        return (sentence.clone(), sentence);
    }
    (reason.clone(), reason + would_pass)
}

impl VerdictReport {
    /// With the answers for the motor, on this bridge, and for the supply that the file states, if it states them, and
    /// warnings about numbers that no device has.
    fn with_facts_of(
        mut self,
        file: &SceneFile,
        bridge: Result<Option<MotorOnBridge>, String>,
    ) -> Self {
        self.warnings.extend(file::warnings(file));
        if let Some(host) = &file.host {
            self.add_host(file, host);
        }
        if let Err(why) = bridge {
            self.refuse_motor(why);
        }
        self.supply = regeneration::judge(file);
        let Some(supply) = &self.supply else { return self };
        if !supply.sinks {
            self.assumptions.push(regeneration::ASSUMPTION.to_owned());
        }
        if let Some(reason) = self.board.as_ref().filter(|_| !self.is_for_a_board) {
            self.summary = on_board::rejected(reason);
            self.message.clone_from(&self.summary);
        }
        self.is_for_a_board = true;
        self
    }

    /// Takes a host's share from the margins of a certified scene, or rejects the scene.
    fn add_host(&mut self, file: &SceneFile, host: &HostTorque) {
        if self.verdict != Verdict::Certified {
            if !self.remedies.is_empty() {
                self.warn(beside_host::without_host(host));
            }
            return;
        }
        let is_on_board = self.is_for_a_board && self.is_rendered;
        let margins = [self.margin].into_iter().chain(is_on_board.then_some(self.margin_on_board));
        if let Err(error) = beside_host::check(file, host, margins) {
            return self.reject_host(&error);
        }
        if let Some(error) = beside_host::not_on_a_board(file, host) {
            if self.is_for_a_board {
                return self.reject_host(&error);
            }
            self.board.get_or_insert_with(|| error.to_string());
            (self.on_board, self.is_rendered) = (Some(Verdict::Rejected), false);
        }
        let left = |margin: f64| (margin - host.damping).next_down();
        self.margin = self.margin.map(left);
        self.margin_on_board = self.margin_on_board.map(|margin| left(margin).max(0.0));
        self.delta -= host.damping;
        let budget = beside_host::budget(host);
        self.message += &format!(
            "; a host may give {budget}, for which it has {} N m s/rad of that damping",
            host.damping
        );
        self.assumptions.push(beside_host::assumption(host, self.delta));
        self.host = Some(format!("may give {budget}"));
    }

    /// Adds a sentence to the assumptions, and to those that do not hold.
    fn warn(&mut self, sentence: String) {
        self.assumptions.push(sentence.clone());
        self.warnings.push(sentence);
    }

    /// Refuses a motor that a board's own bridge does not drive: by this sentence, which no remedy answers, or by a
    /// warning beside those of a scene that is not certified.
    fn refuse_motor(&mut self, why: String) {
        let sentence = on_board::rejected(&why);
        if self.verdict == Verdict::Certified {
            (self.summary, self.message, self.board) = (sentence.clone(), sentence, Some(why));
            (self.remedies, self.changes) = (Vec::new(), Vec::new());
            (self.matched, self.no_remedy) = (None, None);
        } else {
            self.warn(sentence);
        }
        self.on_board = Some(Verdict::Rejected);
        (self.is_rendered, self.is_for_a_board) = (false, true);
    }

    fn reject_host(&mut self, error: &HostError) {
        self.verdict = Verdict::Rejected;
        self.reason = "host";
        self.on_board = Some(Verdict::Rejected);
        self.summary = error.to_string();
        self.message = format!("rejected: {error}");
        if let HostError::Share { margin, .. } = error {
            let bound = significant(*margin, 3);
            self.remedies = vec![format!("host damping below {bound} N m s/rad")];
        }
    }

    /// Whether the supply, where one is stated, bears the scene's energy.
    fn is_borne_by_supply(&self) -> bool {
        self.supply.as_ref().is_none_or(|supply| supply.stays_below == Some(true))
    }

    /// Whether the scene is certified, on a board if it states facts of one, and its supply bears its energy.
    pub fn passes(&self) -> bool {
        let is_rendered = !self.is_for_a_board || self.on_board == Some(Verdict::Certified);
        self.verdict == Verdict::Certified && is_rendered && self.is_borne_by_supply()
    }

    /// The verdict in a few words.
    pub fn verdict_in_words(&self) -> &'static str {
        match self.verdict {
            Verdict::Certified if self.passes() => "CERTIFIED",
            Verdict::Certified if self.is_borne_by_supply() => "REJECTED ON A BOARD",
            Verdict::Certified => "REJECTED WITH THIS SUPPLY",
            Verdict::Rejected => "REJECTED",
            Verdict::Undecided => "UNDECIDED",
        }
    }

    /// The margin in words; `None` if it does not exist.
    pub fn margin_in_words(&self) -> Option<String> {
        in_words(self.margin, self.verdict == Verdict::Certified)
    }

    /// The margin on a board in words; `None` where no board renders the scene.
    pub fn margin_on_board_in_words(&self) -> Option<String> {
        in_words(self.margin_on_board, self.is_rendered)
    }
}

fn in_words(margin: Option<f64>, exists: bool) -> Option<String> {
    let words = margin.map(|margin| format!("{} N m s/rad", significant(margin, 6)));
    words.or_else(|| exists.then(|| NO_MARGIN.to_owned()))
}

/// In place of a margin.
const NO_MARGIN: &str = "none is known: where torques lag, and a limit or a face has them judged by a \
                         bound, the coupling is made for this passivity of the device and for no less";

/// Whether the index at the port differs from that of `E'`.
fn has_port_index(scene: &Scene) -> bool {
    lags(scene) || !scene.latency.encoder.is_ideal()
}

/// Whether torques lag, or the coupling has memory.
fn lags(scene: &Scene) -> bool {
    !scene.latency.is_none() || scene.coupling == Coupling::Matched
}

/// The meaning of a certificate.
const CERTIFIED: &str = "no passive hand can make it oscillate";

/// Margin and rest of a certified scene.
fn passed(margin: Option<f64>, rest: Option<&QuantizationBound>) -> String {
    let to_spare = margin.map_or_else(String::new, |margin| {
        let margin = significant(margin, 4);
        format!(
            "; the device may lose {margin} N m s/rad of its damping with everything else \
                 unchanged"
        )
    });
    let rest = rest.map_or_else(String::new, |rest| format!("; at rest {rest}"));
    format!("{to_spare}{rest}")
}

fn enclosure(interval: Option<Interval>) -> Enclosure {
    Enclosure { lo: interval.map(Interval::lo), hi: interval.map(Interval::hi) }
}

/// Angle in rad at which the linear index is reached: searched in the part of the circle that the
/// certificate has enclosed. None where the real part is the same all around.
fn minimum_angle(scene: &Scene, assessment: &Assessment) -> Option<f64> {
    let cosine = assessment.cos_theta?;
    if assessment.rule == Rule::Exact && has_port_index(scene) {
        // The index at the port depends on delta; the enclosure of its place is narrow.
        let is_known = cosine.lo() > -1.0 || cosine.hi() < 1.0;
        return is_known.then(|| libm::acos(cosine.midpoint().clamp(-1.0, 1.0)));
    }
    let transfers = LoopTransfers::in_format(scene, assessment.format).ok()?;
    let judged = match assessment.rule {
        Rule::Exact => transfers.equivalent,
        Rule::Nonlinear => transfers.environment,
    };
    let velocity = Response::new(judged).from_velocity(scene.timing.period);
    let real = |theta: f64| velocity.at_angle(theta).re;
    let angle = |cosine: f64| libm::acos(cosine.clamp(-1.0, 1.0));
    minimizing_angle(real, angle(cosine.hi()), angle(cosine.lo()))
}
