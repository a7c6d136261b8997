use std::collections::BTreeMap;

use haptic_servo::certificate::assess;
use haptic_servo::environment::{Canceller, Environment, Parts, Rational, Wall};
use haptic_servo::scene::{Coupling, Latency, Scene, TimeRange};

use super::*;
use crate::fixture::{STANDARD, on_paddle};

fn rational(numerator: &[f64], denominator: &[f64], delay: usize) -> Rational {
    Rational { delay, ..Rational::of(numerator, denominator).unwrap() }
}

fn judged(scene: &Scene) -> NyquistScene {
    NyquistScene::of("a scene", scene).unwrap()
}

#[test]
fn what_is_drawn_of_a_rigid_coupling_crosses_the_line_where_the_scene_is_rejected() {
    let rejected = on_paddle(Wall::damped(20.0, 0.01, 1).alone(), Coupling::Rigid);
    assert!(assess(&rejected).outcome.is_err());
    let found = judged(&rejected);
    let curve = |role| found.curves.iter().find(|curve| curve.role == role).unwrap();
    let (alone, line) = (curve(Role::Alone), -found.limit.unwrap());
    // The environment alone keeps clear.
    assert!(alone.least_real() > line && curve(Role::Judged).least_real() < line);
    assert!(found.clearance() < 0.0 && found.gain_margin().unwrap() < 1.0);
    let words = words::curve("", &found, alone, true).concat();
    assert!(words.contains("environment without its coupling, not judged"), "{words}");
}

/// A scene of any kind, on both sides of its limit.
fn random(random: &mut fastrand::Rng) -> Scene {
    let between =
        |random: &mut fastrand::Rng, from: f64, to: f64| from + (to - from) * random.f64();
    let delay = random.usize(0..4);
    let mut wall = Wall::damped(between(random, -4.0, 40.0), between(random, -0.01, 0.03), delay);
    if random.u8(0..4) == 0 {
        wall = wall.filtered(between(random, 0.0, 0.95));
    }
    if random.u8(0..4) == 0 {
        wall = wall.behind(0.0);
    }
    let residual = between(random, 0.0, 0.03);
    let environment = match random.u8(0..5) {
        0 => Canceller { residual, delay }.alone(),
        1 => {
            let canceller = Some(Canceller::to(residual));
            Parts { canceller, wall: Some(wall), ..Parts::NONE }.sum()
        }
        2 => {
            let numerator = [between(random, -20.0, 20.0), between(random, -20.0, 20.0)];
            let denominator = [1.0, between(random, -1.2, 1.2), between(random, -0.9, 0.9)];
            Environment::Rational(rational(&numerator, &denominator, delay))
        }
        _ => wall.alone(),
    };
    let coupling = match random.u8(0..4) {
        0 => Coupling::Rigid,
        1 => STANDARD,
        _ => Coupling::Spring { stiffness: between(random, 10.0, 90.0) },
    };
    let mut scene = on_paddle(environment, coupling);
    if random.u8(0..4) == 0 {
        scene.timing.worst_period = Some(between(random, 0.001, 0.003));
    }
    if random.u8(0..6) == 0 {
        scene.torque_limit = Some(1.0);
    }
    scene
}

/// Compares the side of the line with the verdict for random scenes: the numbers of certified and of rejected
/// ones, and of curves by their role.
fn compare_sides(
    (seed, scenes): (u64, usize),
    varied: impl Fn(&mut fastrand::Rng, Scene) -> Scene,
) -> (usize, usize, BTreeMap<&'static str, usize>) {
    let mut seed = fastrand::Rng::with_seed(seed);
    let (mut passed, mut failed, mut by_role) = (0, 0, BTreeMap::new());
    for _ in 0..scenes {
        let scene = random(&mut seed);
        let scene = varied(&mut seed, scene);
        let Ok(found) = NyquistScene::of("random", &scene) else { continue };
        let clearance = found.clearance();
        let near = found.limit.is_some_and(|limit| clearance.abs() < 1e-4 * limit);
        match assess(&scene).outcome {
            // So near the line that a picture does not show the side.
            _ if near => {}
            Ok(()) => {
                assert!(clearance > 0.0, "{clearance} {scene:?}");
                passed += 1;
            }
            // No bound, or poles too close to the circle.
            Err(rejection) if rejection.is_undecided() => {
                let is_late = scene.latency != Latency::NONE;
                assert!(is_late || clearance.is_nan() || clearance <= 0.0, "{clearance} {scene:?}");
            }
            Err(rejection) => {
                // Without a coupling a limited scene is rejected for its small motions, and has no line.
                let is_at_port = scene.coupling == Coupling::Rigid && clearance.is_nan();
                assert!(clearance < 0.0 || is_at_port, "{clearance} {rejection} {scene:?}");
                failed += 1;
            }
        }
        for curve in &found.curves {
            *by_role.entry(curve.role.as_str()).or_insert(0) += 1;
        }
    }
    (passed, failed, by_role)
}

#[test]
fn the_drawn_side_of_the_line_is_the_verdict_where_torques_lag() {
    let time = |seed: &mut fastrand::Rng, most: f64| match seed.bool() {
        true => TimeRange::exactly(most * seed.f64()),
        false => TimeRange::ZERO,
    };
    let late = |seed: &mut fastrand::Rng, mut scene: Scene| {
        (scene.timing.worst_period, scene.torque_limit) = (None, None);
        scene.latency = Latency {
            output_delay: time(seed, 2.5e-3),
            actuator_lag: time(seed, 1e-3),
            sensor_lag: time(seed, 1e-3),
            ..Latency::NONE
        };
        if seed.u8(0..4) == 0 {
            scene.coupling = Coupling::Matched;
        }
        scene
    };
    let (passed, failed, _) = compare_sides((8, 200), late);
    assert!(passed > 20 && failed > 60, "{passed} {failed}");
}

#[test]
fn the_drawn_side_of_the_line_is_the_verdict() {
    let (passed, failed, by_role) = compare_sides((7, 600), |_, scene| scene);
    assert!(passed > 40 && failed > 200, "{passed} {failed}");
    assert!(by_role.len() == 4 && by_role.values().all(|count| *count > 20), "{by_role:?}");
}

#[test]
fn margins_are_what_it_takes_to_touch_the_line() {
    // alpha = K T / 2 + B = 0.021
    let found = judged(&on_paddle(Wall::damped(22.0, 0.01, 1).alone(), STANDARD));
    assert!((found.gain_margin().unwrap() - 22.0 / 21.0).abs() < 1e-9);
    // Its curve goes to infinity, where any lag turns it across the line.
    assert!(found.phase_margin(&found.curves[0]).is_none());
    // A circle around the origin of radius B: never as far as the line.
    let damper = judged(&on_paddle(Wall::damped(0.0, 0.01, 1).alone(), STANDARD));
    assert!(damper.phase_margin(&damper.curves[0]).is_none());
    // A curve whose delayed value is at -B only where it is far below: turned by the angle found, its least
    // real part is on the line.
    let environment = rational(&[27.0, -27.0], &[1.0, -0.5], 1);
    let found = judged(&on_paddle(Environment::Rational(environment), STANDARD));
    let (turn, _, _) = found.phase_margin(&found.curves[0]).unwrap();
    let (sin, cos) = turn.sin_cos();
    let turned = found.curves[0].values().map(|(re, im)| re * cos + im * sin);
    let least = turned.fold(f64::INFINITY, f64::min);
    assert!((least + 0.022).abs() < 1e-5, "{least} {turn}");
}
