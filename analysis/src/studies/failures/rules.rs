//! Rules of thumb, and theorems without one of their conditions.

use std::f64::consts::PI;

use haptic_servo::environment::Environment;
use haptic_servo::scene::Device;
use nalgebra::Complex;

use super::setting::*;

/// Continuous time: a mass, a damper and any spring come to rest.
pub fn continuous_time() -> Result<CaseReport, StudyError> {
    const STIFFNESS: f64 = 5000.0;
    let scene = rigid(KNOB, wall_of(STIFFNESS, 0.0, 0));
    // m s^2 + b s + K = 0
    let Device { inertia, damping, .. } = KNOB;
    let root = Complex::from(damping * damping - 4.0 * inertia * STIFFNESS).sqrt();
    let slowest = ((root - damping) / (2.0 * inertia)).re;
    let reason = "the slowest root of m s^2 + b s + K has the real part {} 1/s, whatever K > 0";
    // K/(j w): a spring is lossless.
    let lossless = "in continuous time a spring's real part is {} N m s/rad at every frequency";
    let rule = |method, is_safe, figure, reason| {
        MethodResult::new(method, MethodVerdict::of(is_safe), figure, reason)
    };
    let methods = vec![
        rule("continuous time", slowest < 0.0, slowest, reason),
        rule("continuous-time passivity", 0.0 < damping, 0.0, lossless),
    ];
    let shakes = loop_run("5000 N m/rad", &scene, KNOBS, Outcome::Diverges)
        .pushed(1.0, 1000)
        .with_claimed_passivity(10.0);
    let rests = rigid(KNOB, wall_of(900.0, 0.0, 0));
    let rests = loop_run("900 N m/rad", &rests, KNOBS, Outcome::Converges).pushed(1.0, 3000);
    CaseReport::of(&scene, methods, MethodResult::in_no_hand(&scene)?, &[shakes, rests])
}

/// Colgate's and Schenkel's inequality alone: a negative spring passes.
pub fn negative_spring() -> Result<CaseReport, StudyError> {
    const STIFFNESS: f64 = -200.0;
    let spring = |stiffness: f64| Environment::Rational(rational(&[stiffness], &[1.0]));
    let scene = rigid(KNOB, spring(STIFFNESS));
    let needed = colgate_schenkel(&scene)?;
    let reason = "b > T/(2 (1 - cos)) Re((1 - e^-j) C) asks for b above {} N m s/rad";
    let enough = scene.device.damping > needed;
    let residue = controller(&scene)?.at(Complex::from(1.0)).re;
    let pulls = "and C(1) = {} N m/rad must not be negative";
    let (alone, both) = (MethodVerdict::of(enough), MethodVerdict::of(enough && residue >= 0.0));
    let methods = vec![
        MethodResult::new("Colgate-Schenkel without the residue", alone, needed, reason),
        MethodResult::new("the same with it", both, residue, pulls),
    ];
    let runs_away = loop_run("-200 N m/rad", &scene, KNOBS, Outcome::Diverges).pushed(0.01, 2000);
    let rests =
        loop_run("200 N m/rad", &rigid(KNOB, spring(-STIFFNESS)), KNOBS, Outcome::Converges);
    let mut rests = rests.pushed(1.0, 3000);
    rests.experiment.friction = friction_for_rest(&rigid(KNOB, wall_of(200.0, 0.0, 0)), &KNOBS);
    let runs = [runs_away.with_claimed_passivity(10.0), rests];
    CaseReport::of(&scene, methods, MethodResult::in_no_hand(&scene)?, &runs)
}

/// The damping in N m s/rad by Colgate's and Schenkel's inequality, on a fine grid.
fn colgate_schenkel(scene: &Scene) -> Result<f64, StudyError> {
    const POINTS: u32 = 10_000;
    let controller = controller(scene)?;
    let at = |theta: f64| {
        let z = Complex::from_polar(1.0, theta);
        let increment = (Complex::from(1.0) - z.inv()) * controller.at(z);
        scene.timing.period / (2.0 * (1.0 - theta.cos())) * increment.re
    };
    let angles = (1..=POINTS).map(|point| PI * f64::from(point) / f64::from(POINTS));
    Ok(angles.map(at).fold(f64::NEG_INFINITY, f64::max))
}

/// The rule `K < (b + B) / (T/2 + t_d)` at `B = b`.
pub fn damped_rule() -> Result<CaseReport, StudyError> {
    const DELAY: usize = 1;
    let damping = PADDLE.damping;
    let limit = (PADDLE.damping + damping) / (PERIOD * (0.5 + DELAY as f64));
    let stiffness = 0.7 * limit;
    let scene = rigid(PADDLE, wall_of(stiffness, damping, DELAY));
    let undamped = PADDLE.damping / (PERIOD * (0.5 + DELAY as f64));
    let rule = |method, limit| MethodResult::bound(method, stiffness, limit, "allows {} N m/rad");
    let methods = vec![rule("K < (b + B)/(T/2 + t_d)", limit), rule("K < b/(T/2 + t_d)", undamped)];
    let shakes =
        loop_run("B = b, 0.7 of that", &scene, PADDLES, Outcome::Diverges).pushed(5.0, 100);
    let without = coupled(PADDLE, wall_of(0.0, 0.5 * damping, DELAY));
    let rests = coupled(PADDLE, wall_of(0.95 * limit_of(&without)?, 0.5 * damping, DELAY));
    let rests = loop_run("B = b/2 behind the coupling", &rests, PADDLES, Outcome::Converges);
    let runs = [shakes.with_claimed_passivity(10.0), rests.pushed(1.0, 2000)];
    CaseReport::of(&scene, methods, MethodResult::in_no_hand(&scene)?, &runs)
}
