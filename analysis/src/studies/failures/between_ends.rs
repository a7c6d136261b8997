//! Certificates of both ends of a range do not cover a loop between them.
//!
//! A servo computes `F(k+1) = E (x(k) - V F(k))` ahead and writes it a few microseconds after the next count.
//! The torque of its count is late behind its coupling, but not at the motor: neither the wall that is one
//! sample late nor the undelayed wall, both behind the coupling, is that loop.

use haptic_servo::environment::{Coefficients, Environment, Rational};
use haptic_servo::scene::{Coupling, Latency, Scene};
use haptic_servo::servo::Transducers;

use super::case::{CaseResult, FailureError};
use super::method_result::MethodResult;
use super::motion::Outcome;
use super::setting::{PADDLE, PADDLES, PERIOD, coupled, loop_run, rigid, wall_of};

/// Stiffness in N m/rad and damping in N m s/rad of the wall.
const WALL: (f64, f64) = (22.0, 0.01);
/// Time in s from a count to the torque that was computed from the previous count.
const WRITTEN: f64 = 5e-6;

/// The wall with this delay in samples behind the standard coupling.
fn end(delay: usize) -> Scene {
    coupled(PADDLE, wall_of(WALL.0, WALL.1, delay))
}

/// The running loop: `H = E / (1 + V E / z)` without a coupling, written with this delay.
pub fn between() -> Scene {
    let Coupling::Spring { stiffness } = end(0).coupling else { unreachable!("a spring") };
    let (stiff, lost) = (WALL.0 + WALL.1 / PERIOD, WALL.1 / PERIOD);
    let polynomial = |values: &[f64]| Coefficients::new(values).expect("three coefficients fit");
    let loop_between = Environment::Rational(Rational {
        numerator: polynomial(&[stiff, -lost, 0.0]),
        denominator: polynomial(&[1.0, stiff / stiffness, -lost / stiffness]),
        delay: 0,
        unit_zeros: 0,
    });
    Scene { latency: Latency::delayed(WRITTEN), ..rigid(PADDLE, loop_between) }
}

/// Both ends certify, and the loop between them oscillates without a hand.
pub fn between_ends() -> Result<CaseResult, FailureError> {
    let of_end = |method: &str, delay| MethodResult {
        method: method.into(),
        ..MethodResult::certificate(&end(delay))
    };
    let methods = vec![
        of_end("certificate of the wall, one sample late", 1),
        of_end("certificate of the wall, not late", 0),
    ];
    let scene = between();
    let truth = MethodResult::in_no_hand(&scene)?;
    // Small steps, so that the motion begins above them.
    let counts_per_turn = f64::from(1 << 22);
    let fine = Transducers { counts_per_turn, full_scale_torque: 2.0, ..PADDLES };
    let mut shakes = loop_run("computed ahead, written 5 us late", &scene, fine, Outcome::Diverges)
        .pushed(1.0, 300)
        .with_claimed_passivity(30.0);
    shakes.experiment.friction = 0.0;
    let matched = Scene { coupling: Coupling::Matched, latency: scene.latency, ..end(0) };
    let rests =
        loop_run("the wall behind the matched coupling", &matched, PADDLES, Outcome::Converges);
    Ok(CaseResult::of(&scene, methods, truth, [shakes, rests.pushed(1.0, 2000)]))
}
