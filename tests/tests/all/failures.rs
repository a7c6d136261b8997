//! Where methods fail: every verdict that has to be wrong is, ours is not, and the loops do what was said,
//! also with a servo.
//!
//! Figures of methods are computed here once more, by other means.

use std::f64::consts::TAU;

use analysis::studies::failures::method_result::Failure;
use analysis::studies::failures::report::CaseReport;
use analysis::studies::failures::setting::{KNOB, PADDLES, PERIOD};
use analysis::studies::failures::varying_hand::{self, VaryingHand};
use analysis::studies::failures::{ALL, zigzag};

/// The verdicts of each case that are wrong: they say safe.
const WRONG: &[(&str, usize)] = &[
    ("semi-implicit-euler", 2),
    ("continuous-time", 2),
    ("negative-spring", 1),
    ("damped-rule", 1),
    ("grid", 4),
    ("zigzag", 1),
    ("mean-delay", 3),
    ("between-ends", 2),
    ("varying-hand", 2),
    ("ratchet", 2),
];

/// Cases with a torque profile, or with a scene that a board refuses whatever its device.
const WITHOUT_SERVO: [&str; 3] = ["negative-spring", "grid", "ratchet"];

#[test]
fn methods_fail_and_the_certificate_had_said_so() {
    assert_eq!(ALL.len(), WRONG.len());
    for (case, (name, dangerous)) in ALL.iter().zip(WRONG) {
        assert_eq!(case.name, *name);
        let report = case.report().unwrap_or_else(|error| panic!("{name}: {error}"));
        let wrong = |failure| report.methods.iter().filter(|j| j.failure == Some(failure)).count();
        assert_eq!(wrong(Failure::Dangerous), *dangerous, "{name}");
        assert_eq!(wrong(Failure::Needless), 0, "{name}");
        assert_eq!(report.certificate.failure(report.truth.verdict), None, "{name}");
        for seen in &report.runs {
            assert!(seen.is_as_expected(), "{name}: {seen:?}");
            assert!(seen.servo.is_some() || WITHOUT_SERVO.contains(name), "{name}: {seen:?}");
        }
        assert!(report.holds(), "{name}");
    }
}

fn report(name: &str) -> CaseReport {
    ALL.iter().find(|case| case.name == name).unwrap().report().unwrap()
}

fn figure(report: &CaseReport, method: &str) -> f64 {
    let judged = report.methods.iter().find(|judged| judged.result.method == method);
    judged.unwrap_or_else(|| panic!("{method}")).result.figure.unwrap()
}

fn near(is: f64, should: f64, part: f64) {
    assert!((is - should).abs() <= part * should.abs(), "{is} instead of {should}");
}

/// Position and velocity of the knob after a tick under a spring, by semi-implicit Euler, as two
/// columns; its eigenvalues from trace and determinant.
fn semi_implicit_grows(stiffness: f64, substeps: u32) -> bool {
    let h = PERIOD / f64::from(substeps);
    let tick = |mut x: f64, mut v: f64| {
        let torque = -stiffness * x;
        for _ in 0..substeps {
            v += h * (torque - KNOB.damping * v) / KNOB.inertia;
            x += h * v;
        }
        (x, v)
    };
    let ((a, c), (b, d)) = (tick(1.0, 0.0), tick(0.0, 1.0));
    let (trace, determinant) = (a + d, a * d - b * c);
    // Jury's conditions.
    determinant.abs() > 1.0 || trace.abs() > 1.0 + determinant
}

#[test]
fn the_limits_that_methods_show_are_their_recursions() {
    let report = report("semi-implicit-euler");
    for substeps in [1, 2, 10] {
        let (mut low, mut high) = (1.0, 1e6);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if semi_implicit_grows(middle, substeps) { high = middle } else { low = middle }
        }
        let steps = if substeps == 1 { "step" } else { "steps" };
        let method = format!("semi-implicit Euler, {substeps} {steps} a tick");
        near(figure(&report, &method), low, 1e-6);
    }
    near(figure(&report, "semi-implicit Euler, 1 step a tick"), 199_000.0, 1e-9);
    // The determinant of the exact tick reaches 1.
    let a = KNOB.damping * PERIOD / KNOB.inertia;
    let gone = -(-a).exp_m1();
    let force = (PERIOD - gone * KNOB.inertia / KNOB.damping) / KNOB.damping;
    let cross = gone * KNOB.inertia / KNOB.damping * (gone / KNOB.damping) - (1.0 - gone) * force;
    near(report.truth.figure.unwrap(), gone / cross, 1e-9);
}

/// Over an edge and back a spring's torque differs by a step, and a damper's by twice its own.
#[test]
fn the_friction_of_section_8_is_the_least() {
    let (step, wall) = (TAU / PADDLES.counts_per_turn, zigzag::wall());
    let least = 20.0 * step / 2.0 + 0.005 * step / PERIOD;
    assert!(zigzag::gained(&wall, 0.999 * least).unwrap() > 0.0);
    assert!(zigzag::gained(&wall, 1.001 * least).unwrap() < 0.0);
    assert!(wall.certify().is_ok());
}

/// The hand that varies is passive: its ways never return more than they were given, and none of them by itself
/// grows.
#[test]
fn a_hand_that_varies_is_passive() {
    let hand = VaryingHand::against(&varying_hand::at(1.005)).unwrap();
    let [one, other] = hand.ways;
    let returned = one.weight * one.weight + other.weight * other.weight;
    assert!((returned - 1.0).abs() < 1e-12, "{returned}");
    assert!(one.pole.abs() < 1.0 && other.pole.abs() < 1.0, "{hand:?}");
}
