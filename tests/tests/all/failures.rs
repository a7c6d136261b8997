//! Where methods fail: every verdict that has to be wrong is, ours is not, and the loops do what was said
//! with the emulated board as their servo.
//!
//! Figures of methods are computed here once more, by other means.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use analysis::emulator::Client;
use analysis::studies::failures::loop_run::BoardResult;
use analysis::studies::failures::method_result::Failure;
use analysis::studies::failures::motion::Outcome;
use analysis::studies::failures::report::CaseReport;
use analysis::studies::failures::setting::{KNOB, PADDLE, PADDLES, PERIOD};
use analysis::studies::failures::varying_hand::{self, VaryingHand};
use analysis::studies::failures::{ALL, Case, roots, setting, zigzag};
use haptic_servo::environment::{Environment, Rational};
use haptic_servo::scene::Scene;
use tests::exact::{Q, of_f64};
use tests::index::Index;
use tests::poly::Poly;
use tests::remainders::is_schur;

use crate::toolchain::harness;

/// The verdicts of each case that are wrong: those that say safe, and those that say unsafe.
const WRONG: &[(&str, usize, usize)] = &[
    ("explicit-euler", 0, 2),
    ("semi-implicit-euler", 2, 0),
    ("continuous-time", 2, 0),
    ("negative-spring", 1, 0),
    ("damped-rule", 1, 0),
    ("grid", 4, 0),
    ("pole-outside", 1, 0),
    ("pole-inside", 0, 1),
    ("encoder", 2, 0),
    ("zigzag", 1, 0),
    ("missed-ticks", 2, 0),
    ("mean-delay", 3, 0),
    ("between-ends", 2, 0),
    ("varying-hand", 2, 0),
    ("ratchet", 2, 0),
];

/// Cases that a board does not run, or refuses whatever the device.
const REFUSED: [&str; 2] = ["negative-spring", "grid"];

/// On this machine, and where there is a board on that, too.
fn check_all(board: &mut Option<Client>) {
    assert_eq!(ALL.len(), WRONG.len());
    for (case, (name, dangerous, needless)) in ALL.iter().zip(WRONG) {
        assert_eq!(case.name, *name);
        let report = case.report(board).unwrap_or_else(|error| panic!("{name}: {error}"));
        let wrong = |failure| report.methods.iter().filter(|j| j.failure == Some(failure)).count();
        assert_eq!(wrong(Failure::Dangerous), *dangerous, "{name}");
        assert_eq!(wrong(Failure::Needless), *needless, "{name}");
        assert_eq!(report.certificate.failure(report.truth.verdict), None, "{name}");
        for seen in &report.runs {
            assert!(seen.is_as_expected(), "{name}: {seen:?}");
            let refused = seen.emulated == Some(BoardResult::Refused);
            assert!(!refused || REFUSED.contains(name), "{name}: {seen:?}");
        }
        assert!(report.holds(), "{name}");
    }
}

#[test]
fn methods_fail_and_the_certificate_had_said_so() {
    check_all(&mut None);
}

#[test]
#[ignore = "builds for minutes"]
fn loops_do_what_was_said_on_the_emulated_board() {
    let mut player = Some(Client::boot(&harness("servo_server")).unwrap());
    check_all(&mut player);
    // Poles that rounding cannot separate from the circle are not run by a board, whatever its device.
    let mut player = player.unwrap();
    for pole in [1.0 + roots::BESIDE, 1.0 - roots::BESIDE] {
        let loop_run =
            setting::loop_run("a pole", &roots::scene(pole), PADDLES, Outcome::Converges);
        assert_eq!(
            loop_run.with_claimed_passivity(100.0).emulated(&mut player).unwrap(),
            BoardResult::Refused
        );
    }
    player.finish().unwrap();
}

fn report(name: &str) -> CaseReport {
    Case::find(name).unwrap().report(&mut None).unwrap()
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

fn q(value: f64) -> Q {
    of_f64(value).unwrap()
}

/// Numerator and denominator of a rational environment.
fn fraction(scene: &Scene) -> (Poly, Poly) {
    let Environment::Rational(Rational { numerator, denominator, delay, unit_zeros }) =
        scene.environment
    else {
        panic!("a rational environment")
    };
    let poly = |values: &[f64]| {
        Poly::descending(&values.iter().map(|&value| q(value)).collect::<Vec<_>>())
    };
    let numerator =
        (0..unit_zeros).fold(poly(numerator.as_slice()), |p, _| p.times(&Poly::integers(&[-1, 1])));
    (numerator, poly(denominator.as_slice()).raised(delay))
}

#[test]
fn what_grids_and_roots_miss_is_decided_in_rational_arithmetic() {
    let result = Case::find("grid").unwrap().evaluate().unwrap();
    let scene = result.runs[0].experiment.scene;
    let (numerator, denominator) = fraction(&scene);
    let alpha = Index::of(&numerator, &denominator, &q(scene.timing.period)).unwrap();
    assert_eq!(alpha.compare(&q(100.0 * PADDLE.damping)), Ordering::Greater);
    assert_eq!(alpha.compare(&q(101.0 * PADDLE.damping)), Ordering::Less);
    for (pole, is_inside) in [(1.0 + roots::BESIDE, false), (1.0 - roots::BESIDE, true)] {
        let denominator = fraction(&roots::scene(pole)).1;
        assert!(denominator.at(&q(pole)) == q(0.0), "no coefficient is rounded");
        assert_eq!(is_schur(&denominator), is_inside);
    }
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
