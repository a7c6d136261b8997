//! Where methods fail, and both sides of the certificate's line: every verdict that has to be wrong is,
//! ours is not, and the loops do what was said with the emulated board as their servo.
//!
//! The numbers are computed here once more, by other means.

use std::f64::consts::TAU;

use analysis::chain::Chain;
use analysis::emulator::ServoClient;
use analysis::studies::failures::loop_run::BoardResult;
use analysis::studies::failures::method_result::Failure;
use analysis::studies::failures::motion::Outcome;
use analysis::studies::failures::report::{CaseReport, walls};
use analysis::studies::failures::setting::{KNOB, PADDLE, PADDLES, PERIOD};
use analysis::studies::failures::varying_hand::VaryingHand;
use analysis::studies::failures::{ALL, Case, roots, setting, varying_hand, walls as wall, zigzag};
use analysis::toolchain::{Tools, prepare};
use analysis::worst_hand::{Absorber, HandImpedance, search};
use haptic_servo::environment::{Environment, Parts, Rational};
use haptic_servo::scene::{Coupling, Scene};
use nalgebra::{SMatrix, SVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::cmp::Ordering;
use tests::exact::{Q, of_f64};
use tests::hands::Hand;
use tests::plant::{Controller, Plant};
use tests::poly::Poly;
use tests::remainders::is_schur;
use tests::rules::Exact;

use super::lagging::Loop;
use super::worst_hand::radius;

fn board() -> ServoClient {
    let toolchain = prepare(Tools::CompilerAndEmulator, |step| eprintln!("{step}"))
        .unwrap_or_else(|error| panic!("{error}"));
    ServoClient::boot(
        &toolchain.build_harness("servo_server").unwrap_or_else(|error| panic!("{error}")),
    )
    .unwrap()
}

/// The verdicts of each case that are wrong: those that say safe, and those that say unsafe.
const WRONG: &[(&str, usize, usize)] = &[
    ("explicit-euler", 0, 2),
    ("semi-implicit-euler", 2, 0),
    ("runge-kutta", 1, 0),
    ("continuous-time", 2, 0),
    ("negative-spring", 1, 0),
    ("damped-rule", 1, 0),
    ("grid", 4, 0),
    ("pole-outside", 1, 0),
    ("pole-inside", 0, 1),
    ("passivity-observer", 0, 2),
    ("fixed-point", 2, 0),
    ("encoder", 2, 0),
    ("zigzag", 1, 0),
    ("missed-ticks", 2, 0),
    ("mean-delay", 3, 0),
    ("between-ends", 2, 0),
    ("varying-hand", 2, 0),
    ("fine-detents", 2, 0),
    ("ratchet", 2, 0),
];

/// Cases that a board does not run, or refuses whatever the device.
const REFUSED: [&str; 2] = ["negative-spring", "grid"];

#[test]
fn methods_fail_and_the_certificate_had_said_so() {
    let mut player = Some(board());
    assert_eq!(ALL.len(), WRONG.len());
    for (case, (name, dangerous, needless)) in ALL.iter().zip(WRONG) {
        assert_eq!(case.name, *name);
        let report = case.report(&mut player).unwrap_or_else(|error| panic!("{name}: {error}"));
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

/// A linear scene of springs and rational environments in exact numbers.
fn exact(scene: &Scene) -> Exact {
    let (numerator, denominator) = match scene.environment {
        Environment::Parts(Parts { canceller: None, wall: Some(wall), profile: None }) => {
            assert_eq!(wall.damping(), 0.0);
            (Poly::ascending(vec![q(wall.stiffness)]), Poly::integers(&[1]).raised(wall.delay))
        }
        Environment::Rational(Rational { numerator, denominator, delay, unit_zeros }) => {
            let poly = |values: &[f64]| {
                Poly::descending(&values.iter().map(|&value| q(value)).collect::<Vec<_>>())
            };
            let zeros = (0..unit_zeros)
                .fold(Poly::integers(&[1]), |product, _| product.times(&Poly::integers(&[-1, 1])));
            (poly(numerator.as_slice()).times(&zeros), poly(denominator.as_slice()).raised(delay))
        }
        _ => panic!("no other environment is asked about"),
    };
    Exact {
        numerator,
        denominator,
        period: q(scene.timing.period),
        delta: q(scene.device.passivity.unwrap_or(scene.device.damping)),
        coupling: match scene.coupling {
            Coupling::Rigid => None,
            Coupling::Matched => unreachable!("not drawn"),
            Coupling::Spring { stiffness } => Some(q(stiffness)),
        },
    }
}

#[test]
fn what_grids_and_roots_miss_is_decided_in_rational_arithmetic() {
    let result = Case::find("grid").unwrap().evaluate().unwrap();
    let resonance = exact(&result.runs[0].experiment.scene);
    assert!(!resonance.passes_exact() && !resonance.passes_paper());
    let alpha = resonance.alpha().unwrap();
    assert_eq!(alpha.compare(&q(100.0 * PADDLE.damping)), Ordering::Greater);
    assert_eq!(alpha.compare(&q(101.0 * PADDLE.damping)), Ordering::Less);
    for (pole, is_inside) in [(1.0 + roots::BESIDE, false), (1.0 - roots::BESIDE, true)] {
        let denominator = exact(&roots::scene(pole)).denominator;
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

#[test]
fn an_observer_asks_for_what_no_motor_has() {
    let report = report("passivity-observer");
    let [always, guarded] = &report.methods[..] else { panic!("two observers") };
    assert!(always.result.reason.starts_with("the torque is not a number"), "{always:?}");
    assert!(guarded.result.figure.unwrap() > 100.0 * PADDLES.full_scale_torque, "{guarded:?}");
}

/// In units of the loop: period and damping are 1.
const SPRING: Loop = Loop {
    stiffness: 0.0,
    damping: 0.0,
    filter: 0.0,
    delay: 0,
    coupling: None,
    output_delay: 0.0,
    actuator_lag: 0.0,
    sensor_lag: 0.0,
    updates: 0,
    section: None,
};

fn in_units_of_the_loop(hand: &HandImpedance) -> HandImpedance {
    let (mass, spring) = (PADDLE.damping * PERIOD, PADDLE.damping / PERIOD);
    let absorber = |absorber: &Absorber| Absorber {
        inertia: absorber.inertia / mass,
        stiffness: absorber.stiffness / spring,
    };
    assert!(hand.link.is_none());
    HandImpedance {
        inertia: hand.inertia / mass,
        damping: hand.damping / PADDLE.damping,
        stiffness: hand.stiffness / spring,
        link: None,
        absorbers: hand.absorbers.iter().map(absorber).collect(),
    }
}

/// The spring that the sum of all delays allows grows in a passive hand, by a model of the tests' own.
#[test]
fn the_sum_of_delays_allows_a_spring_that_grows() {
    let result = Case::find("mean-delay").unwrap().evaluate().unwrap();
    let scene = result.runs[0].experiment.scene;
    let wall = scene.environment.wall().expect("a spring");
    near(wall.stiffness, 0.99 * 0.022 / (1e-3 + 1.0 / (TAU * 3e3)), 1e-12);
    let device = Chain::rigid(PADDLE.inertia, PADDLE.damping).unwrap();
    let found = search(&scene, &device).unwrap();
    let drawn = Loop {
        stiffness: wall.stiffness * PERIOD / PADDLE.damping,
        output_delay: 0.5,
        actuator_lag: 1.0 / (TAU * 3e3) / PERIOD,
        ..SPRING
    };
    let inertia = PADDLE.inertia / (PADDLE.damping * PERIOD);
    let grown = radius(&drawn, inertia, 1.0, &in_units_of_the_loop(&found.worst.hand));
    near(grown - 1.0, found.worst.spectral_radius - 1.0, 1e-3);
    assert!(grown > 1.0 + 1e-4, "{grown}");
    near(result.truth.figure.unwrap(), grown, 1e-6);
}

/// `F(k+1) = E (x(k) - V F(k))`, each written 5 us after its count, tick by tick.
#[test]
fn between_two_certified_ends_the_bare_device_shakes() {
    let result = Case::find("between-ends").unwrap().evaluate().unwrap();
    near(result.certificate.figure.unwrap(), 0.46, 2e-3);
    let (stiffness, damping, written) = (22.0, 0.01, 5e-6);
    let compliance = PERIOD / (2.0 * PADDLE.damping);
    let rate = PADDLE.damping / PADDLE.inertia;
    let step = |x: &mut f64, v: &mut f64, torque: f64, time: f64| {
        let (rest, gone) = (torque / PADDLE.damping, -(-rate * time).exp_m1());
        *x += rest * time + (*v - rest) * gone / rate;
        *v += (rest - *v) * gone;
    };
    let (mut x, mut v, mut torque, mut deflected) = (0.0, 1e-3, 0.0, 0.0);
    let mut most = Vec::new();
    for _ in 0..4000 {
        let now = x - compliance * torque;
        let next = stiffness * now + damping * (now - deflected) / PERIOD;
        step(&mut x, &mut v, -torque, written);
        step(&mut x, &mut v, -next, PERIOD - written);
        (torque, deflected) = (next, now);
        most.push(x.abs());
    }
    let growth = (most[3999] / most[1999]).powf(1.0 / 2000.0);
    near(growth - 1.0, result.truth.figure.unwrap() - 1.0, 1e-6);
    near(growth, 1.022, 1e-3);
}

/// The loop in the hand that varies, for a device without inertia, in closed form; and that hand alone,
/// which never gives more than it was given.
#[test]
fn a_passive_hand_that_varies_shakes_what_no_other_does() {
    let limit = |times: f64| {
        let scene = varying_hand::at(times);
        let hand = VaryingHand::against(&scene).unwrap();
        let [one, other] = hand.ways;
        near(one.weight * one.weight + other.weight * other.weight, 1.0, 1e-12);
        assert!(one.pole.abs() < 1.0 && other.pole.abs() < 1.0, "{hand:?}");
        (hand.multiplier(&scene).unwrap(), without_inertia(&scene, &hand))
    };
    for (times, least, most) in [(0.995, -6e-4, -3e-4), (1.005, 3e-4, 6e-4), (1.02, 1.5e-3, 2e-3)] {
        let (found, massless) = limit(times);
        assert!((least..most).contains(&(found - 1.0)), "{times}: {found}");
        assert!((least..most).contains(&(massless - 1.0)), "{times}: {massless}");
    }
    // At the limit itself the multiplier is 1.
    assert!((limit(1.0).1 - 1.0).abs() < 1e-9);
    let scene = varying_hand::at(1.005);
    let Environment::Rational(Rational { numerator, .. }) = scene.environment else { panic!() };
    let drawn = Loop {
        stiffness: numerator.as_slice()[0] * PERIOD / PADDLE.damping,
        delay: 1,
        actuator_lag: varying_hand::LAG / PERIOD,
        section: Some([0.0, 0.0, varying_hand::RESONANCE[1], varying_hand::RESONANCE[2]]),
        ..SPRING
    };
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for n in 0..300 {
        let hand = if n % 2 == 0 { Hand::draw(&mut rng) } else { Hand::tuned(&mut rng, 2.688) };
        let radius = drawn.radius(&hand, &[]);
        assert!(radius < 1.0 + 1e-7, "{hand:?} {radius}");
    }
}

/// Growth a period in the hand, without inertia: position, amplifier, both ways, the resonance. Torques over
/// a period are `command + rest exp(-t/tau)`, whose integrals are known.
fn without_inertia(scene: &Scene, hand: &VaryingHand) -> f64 {
    let Environment::Rational(Rational { numerator, .. }) = scene.environment else { panic!() };
    let gain = numerator.as_slice()[0] * PERIOD / PADDLE.damping;
    let [_, linear, constant] = varying_hand::RESONANCE;
    let tau = varying_hand::LAG / PERIOD;
    let left = (-1.0 / tau).exp();
    let mean = tau * (1.0 - left);
    let norm = (0.5 * tau * (1.0 - left * left) - mean * mean).sqrt();
    let period = |s: &[f64; 8]| {
        let [x, amplifier, a, a1, b, b1, y, y1] = *s;
        let (command, returned) = (-y, hand.ways[0].weight * a + hand.ways[1].weight * b);
        let rest = amplifier - command;
        let incident = [command + rest * mean, rest * norm];
        let [p, q] = hand.ways.map(|way| way.pole);
        [
            x + 0.5 * (incident[0] + returned),
            command + rest * left,
            a1 + p * a - p * incident[0],
            incident[0],
            b1 + q * b - q * incident[1],
            incident[1],
            y1 - linear * y + gain * x,
            -constant * y,
        ]
    };
    let unit = |k: usize| std::array::from_fn(|i| f64::from(u8::from(i == k)));
    let columns: Vec<_> = (0..8).map(|k| SVector::<f64, 8>::from(period(&unit(k)))).collect();
    let mut power = SMatrix::<f64, 8, 8>::from_columns(&columns);
    let (mut growth, mut share) = (0.0, 1.0);
    for _ in 0..36 {
        let norm = power.norm();
        power /= norm;
        growth += share * norm.ln();
        power *= power;
        share *= 0.5;
    }
    growth.exp()
}

#[test]
fn walls_rest_below_the_limit_and_not_above_it() {
    let mut player = Some(board());
    let reports = walls(&mut player).unwrap();
    player.unwrap().finish().unwrap();
    assert_eq!(reports.len(), 5);
    for report in &reports {
        let delay = report.delay as f64;
        let ticks = if report.delay == 0 { 0.5 } else { delay - 0.5 };
        near(report.limit, PADDLE.damping / (PERIOD * ticks), 1e-9);
        assert!(report.holds(), "{report:?}");
        let hand = &report.hand.hand;
        let numbers = [hand.inertia, hand.damping, hand.stiffness];
        assert!(hand.link.is_none() && numbers.iter().all(|number| *number >= 0.0), "{hand:?}");
        // The loop in that hand once more, by the tests' own exponential and eigenvalues.
        let (mass, damping) = (PADDLE.damping * PERIOD, PADDLE.damping);
        let plant = Plant::new(&Hand {
            inertia: (PADDLE.inertia + hand.inertia) / mass,
            damping: hand.damping / damping,
            stiffness: hand.stiffness * PERIOD / damping,
            segments: Vec::new(),
        });
        let wall = wall::wall(report.delay).unwrap();
        for (loop_run, grows) in
            wall.below.iter().map(|below| (below, false)).chain([(&wall.above, true)])
        {
            let controller = Controller::new(&exact(&loop_run.experiment.scene)).unwrap();
            let radius = controller.spectral_radius(&plant).unwrap();
            assert_eq!(radius > 1.0, grows, "{} samples late: {radius}", report.delay);
        }
        // For rest: the friction of section 8, and half a DAC step.
        let friction = 0.5 * 0.99 * report.limit * TAU / PADDLES.counts_per_turn
            + 0.5 * PADDLES.full_scale_torque / 1791.0;
        for below in &wall.below {
            near(below.experiment.friction, friction, 1e-9);
        }
        let boards = report.runs.iter().filter_map(|seen| seen.emulated.as_ref());
        let refused = boards.filter(|board_result| **board_result == BoardResult::Refused).count();
        // One sample late, the controller alone oscillates above the limit: no board can be told
        // of a device on which it would not.
        assert_eq!(refused, usize::from(report.delay == 1));
    }
}
