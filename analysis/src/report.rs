//! One page about a scene, with nothing outside of it: verdict, numbers, assumptions, pictures.

use haptic_servo::environment::AnyProfile;
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::{Coupling, Latency, Scene, TimeRange};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::chart::Picture;
use crate::device::Hand;
use crate::file::{SceneFile, write};
use crate::nominal_latency::titled;
use crate::quantity::significant;
use crate::verdict::{Enclosure, RuleAnswer, Verdict, VerdictReport};

/// The contents of a page.
#[derive(Debug)]
pub struct Page<'p> {
    /// The judged scene.
    pub report: &'p VerdictReport,
    /// Its source file.
    pub file: &'p SceneFile,
    /// Its path, as the user gave it.
    pub path: &'p str,
    /// The day, as 2026-03-14.
    pub date: String,
    /// Its torque profile; `None` for another environment.
    pub profile: Option<Picture>,
    /// The curve of its environment.
    pub nyquist: Figure,
    /// The map of its wall.
    pub map: Figure,
    /// The motion of its simulation.
    pub motion: Figure,
}

/// A picture, or the reason why it is missing.
#[derive(Clone, Debug)]
pub enum Figure {
    /// The picture.
    Drawn(Picture),
    /// The reason.
    Missing(String),
}

/// Black on white with the reader's own fonts; nothing is fetched. Wide things shrink or wrap, so
/// that nothing is cut off on a narrow screen or on paper.
const STYLE: &str = "
body { font-family: sans-serif; color: black; background: white; max-width: 56rem;
       margin: 2rem auto; padding: 0 1rem; line-height: 1.45; overflow-wrap: anywhere; }
h1 { margin-bottom: 0.3rem; }
.verdict { border: 3px solid black; padding: 0.6rem 1rem; }
.verdict strong { font-size: 1.4rem; letter-spacing: 0.05em; }
.certified { border-style: solid; }
.rejected, .undecided { border-style: double; border-width: 6px; background: #e8e8e8; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: 0.25rem 0.8rem 0.25rem 0;
         border-bottom: 1px solid #bbb; font-weight: normal; }
td { font-variant-numeric: tabular-nums; }
figure { margin: 1.5rem 0; break-inside: avoid; }
figure svg { max-width: 100%; height: auto; display: block; }
figcaption { font-size: 0.95rem; margin-top: 0.3rem; }
";

/// Captions of the pictures of a torque profile.
const PROFILE: &str =
    "Torque and potential over angle. The verdict depends on the steepest slopes alone.";
const MAP_OF_PROFILES: &str = "Largest torques with this scene's device, period and coupling.";

impl Page<'_> {
    /// The page as HTML.
    pub fn html(&self) -> String {
        let report = self.report;
        let latency = [&self.file.scene.latency];
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (report.name) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (report.name) }
                    (verdict(report))
                    (origin(self))
                    h2 { "Scene and verdict" }
                    (table("judged", &judged(self.file)))
                    h2 { "Numbers" }
                    (numbers(report, &self.file.scene))
                    @if !report.remedies.is_empty() {
                        h2 { "Remedies" }
                        p { "Each of these changes alone is sufficient." }
                        ul id="remedies" { @for item in &report.remedies { li { (item) } } }
                    }
                    @if !report.warnings.is_empty() {
                        h2 { "Warnings" }
                        ul id="warnings" { @for item in &report.warnings { li { (item) } } }
                    }
                    h2 { "Assumptions" }
                    p { "The verdict holds only if these hold." }
                    ul id="assumptions" { @for item in &report.assumptions { li { (item) } } }
                    h2 { "Pictures" }
                    (figure("nyquist", &self.nyquist, &titled("Nyquist curves from velocity to torque. \
                                                              The black curve decides: it must stay \
                                                              right of the critical line. Grey curves \
                                                              are for comparison.", latency)))
                    @if let Some(profile) = &self.profile {
                        (figure("profile", &Figure::Drawn(profile.clone()), PROFILE))
                        (figure("map", &self.map, MAP_OF_PROFILES))
                    } @else {
                        (figure("map", &self.map, "Verdicts on walls with this scene's device, \
                                                   period, coupling and delay."))
                    }
                    (figure("motion", &self.motion, &titled("Simulation of the scene.", latency)))
                }
            }
        };
        page.into_string()
    }
}

fn verdict(report: &VerdictReport) -> Markup {
    let (class, word) = match report.verdict {
        Verdict::Certified => ("verdict certified", "CERTIFIED"),
        Verdict::Rejected => ("verdict rejected", "REJECTED"),
        Verdict::Undecided => ("verdict undecided", "UNDECIDED"),
    };
    html! {
        div id="verdict" class=(class) {
            strong { (word) }
            p { (report.message) }
        }
    }
}

/// The origin of the page.
fn origin(page: &Page<'_>) -> Markup {
    let version = env!("CARGO_PKG_VERSION");
    html! {
        p id="origin" { "Of " (page.path) ", by haptic " (version) ", on " (page.date) "." }
        p { "To change this scene and to hold it in a browser: " code { "haptic explore " (page.path) " -o explore.html" } }
    }
}

/// Environment, device and hand, with all of their keys.
fn judged(file: &SceneFile) -> Vec<(&'static str, String)> {
    let mut rows = vec![("Environment", write::kind(&file.scene.environment).to_owned())];
    let number = |name, value: f64, unit| (name, format!("{} {unit}", significant(value, 6)));
    let environment = &file.scene.environment;
    rows.extend(environment.residual().map(|left| number("Residual damping", left, "N m s/rad")));
    if let Some(wall) = environment.wall() {
        rows.push(number("Stiffness", wall.stiffness, "N m/rad"));
        rows.push(number("Damping", wall.damping, "N m s/rad"));
        rows.extend(wall.filter.map(|pole| number("Pole of the velocity filter", pole, "")));
        rows.push(number("Face", wall.face, "rad"));
        let sides = if wall.one_sided { "felt beyond the face only" } else { "felt everywhere" };
        rows.push(("Sides", sides.to_owned()));
        if environment.profile().is_some() {
            rows.push(("Delay of the wall", delayed(wall.delay).1));
        }
    }
    rows.extend(environment.profile().map(profile).unwrap_or_default());
    if let Some(rational) = environment.rational() {
        rows.push(("Numerator", format!("{:?}", rational.numerator.as_slice())));
        rows.push(("Denominator", format!("{:?}", rational.denominator.as_slice())));
        rows.push(number("Zeros at z = 1", rational.unit_zeros as f64, ""));
    }
    rows.extend(environment.get(Parameter::Delay).map(|samples| delayed(samples as usize)));
    rows.extend(latency(&file.scene.latency));
    if !file.chain.is_rigid() {
        rows.push(("Device", format!("a chain of {} masses", file.chain.masses().len())));
    }
    rows.push(("Hand, in the simulation", hand(file.hand)));
    rows.extend(
        file.friction.map(|torque| number("Coulomb friction of the device", torque, "N m")),
    );
    rows.extend(file.encoder_step.map(|angle| number("Encoder's step", angle, "rad")));
    rows.extend(file.full_scale.map(|torque| number("Torque at full scale", torque, "N m")));
    rows
}

/// The rows of a torque profile.
fn profile(profile: &AnyProfile) -> Vec<(&'static str, String)> {
    let number = |name, value: f64, unit| (name, format!("{} {unit}", significant(value, 6)));
    let mut rows = vec![number("Largest torque of the profile", profile.torque, "N m")];
    if profile.outline().wraps {
        rows.push(number("Repetitions in a turn", profile.count, ""));
    }
    if let Some(ends) = profile.ends {
        rows.push(number("Lower end stop", ends.from, "rad"));
        rows.push(number("Upper end stop", ends.to, "rad"));
        rows.push(number("Stiffness of the end stops", ends.stiffness, "N m/rad"));
    }
    rows.push(number("Damping", profile.damping, "N m s/rad"));
    rows.push(number("Cells of the table", f64::from(profile.outline().knots), ""));
    rows
}

/// Times between count and torque that the scene has.
fn latency(latency: &Latency) -> Vec<(&'static str, String)> {
    let [output_jitter, count_jitter] =
        [latency.output_jitter, latency.count_jitter].map(TimeRange::exactly);
    let times = [
        ("Delay of the output", latency.output_delay),
        ("Deviation from that delay, at most", output_jitter),
        ("Deviation of the counts, at most", count_jitter),
        ("Lag of the amplifier", latency.actuator_lag),
        ("Lag of the encoder's filter", latency.sensor_lag),
        ("Step response of the amplifier", latency.actuator_response),
    ];
    let text = |time: TimeRange| {
        let [least, most] = [time.least, time.most].map(|end| significant(end, 6));
        if time.is_exact() { format!("{most} s") } else { format!("{least} to {most} s") }
    };
    let present = times.into_iter().filter(|(_, time)| !time.is_zero());
    let mut rows: Vec<_> = present.map(|(name, time)| (name, text(time))).collect();
    if latency.actuator_updates > 0 {
        let updates = latency.actuator_updates.to_string();
        rows.push(("Updates of the amplifier in a period", updates));
    }
    rows
}

fn delayed(samples: usize) -> (&'static str, String) {
    ("Delay", format!("{samples} sample{}", if samples == 1 { "" } else { "s" }))
}

fn hand(hand: Option<Hand>) -> String {
    let Some(Hand { inertia, damping, stiffness }) = hand else {
        return "none; the verdict holds in every passive hand".to_owned();
    };
    format!(
        "{} kg m\u{b2}, {} N m s/rad, {} N m/rad; the verdict holds in every passive hand",
        significant(inertia, 6),
        significant(damping, 6),
        significant(stiffness, 6)
    )
}

fn numbers(report: &VerdictReport, scene: &Scene) -> Markup {
    let (period, device) = (scene.timing.period, scene.device);
    let hertz = significant(1.0 / period, 6);
    let coupling = match scene.coupling {
        Coupling::Rigid => "rigid".to_owned(),
        Coupling::Matched => "matched to the latency".to_owned(),
        Coupling::Spring { stiffness } => format!("{} N m/rad", significant(stiffness, 6)),
    };
    let damping = |value: f64| format!("{} N m s/rad", significant(value, 6));
    let mut rows = vec![
        ("Inertia of the device", format!("{} kg m\u{b2}", significant(device.inertia, 6))),
        ("Damping of the device", damping(device.damping)),
        ("Period", format!("{} s, {hertz} Hz", significant(period, 6))),
        ("Coupling", coupling),
        ("Passivity of the device, delta", damping(report.delta)),
        ("Index of the environment, alpha", enclosure(report.alpha)),
        ("Index with the coupling, alpha", enclosure(report.alpha_coupled)),
    ];
    rows.extend(report.alpha_port.map(|port| ("Index at the port, with latency", enclosure(port))));
    rows.extend(report.margin_in_words().map(|margin| ("Margin", margin)));
    rows.extend(report.theta.map(|theta| {
        let degrees = significant(theta.to_degrees(), 4);
        ("Least real part at", format!("{} rad a sample, {degrees}\u{b0}", significant(theta, 6)))
    }));
    rows.extend(
        scene.torque_limit.map(|limit| ("Torque limit", format!("{} N m", significant(limit, 6)))),
    );
    rows.extend(
        (scene.timing.worst_period)
            .map(|worst| ("Longest time between updates", format!("{} s", significant(worst, 6)))),
    );
    rows.extend(report.format.clone().map(|format| ("Coefficients rounded to", format)));
    if let Some(rest) = &report.rest {
        rows.push(("Torque of all steps at rest", format!("{} N m", significant(rest.hum, 4))));
    }
    rows.extend(report.board.clone().map(|why| ("Not on a board", why)));
    rows.push(("Rule of the paper", answer(report.rules.paper).to_owned()));
    rows.push(("Exact rule", answer(report.rules.exact).to_owned()));
    table("numbers", &rows)
}

fn table(id: &str, rows: &[(&str, String)]) -> Markup {
    html! {
        table id=(id) {
            @for (name, value) in rows { tr { th scope="row" { (name) } td { (value) } } }
        }
    }
}

fn answer(answer: RuleAnswer) -> &'static str {
    match answer {
        RuleAnswer::Pass => "pass",
        RuleAnswer::Fail => "fail",
        RuleAnswer::Undecided => "undecided",
    }
}

fn enclosure(enclosure: Enclosure) -> String {
    match enclosure {
        Enclosure { lo: Some(lo), hi: Some(hi) } => {
            format!("{} N m s/rad", significant(0.5 * (lo + hi), 8))
        }
        _ => "does not exist".to_owned(),
    }
}

fn figure(id: &str, figure: &Figure, caption: &str) -> Markup {
    html! {
        figure id=(id) {
            @match figure {
                Figure::Drawn(picture) => {
                    (PreEscaped(picture.svg()))
                    figcaption { (caption) }
                },
                Figure::Missing(why) => { p { (why) } },
            }
        }
    }
}
