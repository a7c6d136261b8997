//! Timing that a method adds up or rounds: delays and lags, torques written late.

use haptic_servo::environment::Environment;
use haptic_servo::scene::{Coupling, Latency};
use haptic_servo::servo::Transducers;

use super::setting::*;
use crate::chain::Chain;
use crate::latency_limits::{lag_of, largest_spring};
use crate::simulation::{Experiment, Integration};
use crate::worst_hand::{plant, search};

/// Bandwidth of the current loop in Hz.
const BANDWIDTH: f64 = 3e3;
/// Time in s from a count to its torque.
const DELAY: f64 = 0.5 * PERIOD;
/// Part of the limit that the common formula allows.
const PART: f64 = 0.99;

/// The latency between count and torque.
fn latency() -> Latency {
    Latency::delayed(DELAY).with_actuator_lag(lag_of(BANDWIDTH))
}

/// The sum of all delays, instead of the effect of a fractional delay between the samples:
/// a spring at 0.99 of `b/(T/2 + t_d + tau)`, and one at 0.95 of the certified limit.
pub fn mean_delay() -> Result<CaseReport, StudyError> {
    let spring =
        |stiffness| Scene { latency: latency(), ..rigid(PADDLE, wall_of(stiffness, 0.0, 0)) };
    let limit = PADDLE.damping / (0.5 * PERIOD + DELAY + lag_of(BANDWIDTH));
    let without = PADDLE.damping / (0.5 * PERIOD + lag_of(BANDWIDTH));
    let scene = spring(PART * limit);
    let rule =
        |method, allowed| MethodResult::bound(method, PART * limit, allowed, "allows {} N m/rad");
    let alone = Experiment::still(&scene);
    let by_itself = MethodResult::eigenvalues("in no hand", &alone, Integration::default())?;
    let methods =
        vec![rule("K < b/(T/2 + tau)", without), rule("K < b/(T/2 + t_d + tau)", limit), by_itself];
    let device = Chain::rigid(PADDLE.inertia, PADDLE.damping)?;
    let hand = search(&scene, &device)?.worst;
    let held = Experiment { plant: plant(&device, 1.0, &hand.hand), ..alone };
    let truth =
        MethodResult::eigenvalues("exact exponential, in a hand", &held, Integration::default())?;
    let mut shakes = loop_run("0.99 of it, in that hand", &scene, PADDLES, Outcome::Diverges)
        .with_claimed_passivity(2.0);
    shakes.experiment = Experiment { friction: 0.0, ..held };
    // Until the motion has tripled, with bounds for heavy hands.
    let samples = (4.0 / hand.spectral_radius.ln()).clamp(1000.0, 150_000.0) as usize;
    let certified = spring(0.95 * largest_spring(&PADDLE, PERIOD, latency(), 0));
    let rests = loop_run("0.95 of the certified limit", &certified, PADDLES, Outcome::Converges);
    let runs = [shakes.pushed(1.0, samples), rests.pushed(1.0, 4000)];
    CaseReport::of(&scene, methods, truth, &runs)
}

/// Stiffness in N m/rad and damping in N m s/rad of the wall.
const WALL: (f64, f64) = (22.0, 0.01);
/// Time in s from a count to the torque that was computed from the previous count.
const WRITTEN: f64 = 5e-6;

/// The wall with this delay in samples behind the standard coupling.
fn end(delay: usize) -> Scene {
    coupled(PADDLE, wall_of(WALL.0, WALL.1, delay))
}

/// The running loop: `H = E / (1 + V E / z)` without a coupling, written with this delay.
fn between() -> Scene {
    let Coupling::Spring { stiffness } = end(0).coupling else { unreachable!("a spring") };
    let (stiff, lost) = (WALL.0 + WALL.1 / PERIOD, WALL.1 / PERIOD);
    let denominator = [1.0, stiff / stiffness, -lost / stiffness];
    let loop_between = Environment::Rational(rational(&[stiff, -lost, 0.0], &denominator));
    Scene { latency: Latency::delayed(WRITTEN), ..rigid(PADDLE, loop_between) }
}

/// Certificates of both ends of a range do not cover a loop between them: both certify, and it oscillates
/// without a hand.
///
/// A servo computes `F(k+1) = E (x(k) - V F(k))` ahead and writes it a few microseconds after the next count.
/// The torque of its count is late behind its coupling, but not at the motor: neither the wall that is one
/// sample late nor the undelayed wall, both behind the coupling, is that loop.
pub fn between_ends() -> Result<CaseReport, StudyError> {
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
    CaseReport::of(&scene, methods, truth, &[shakes, rests.pushed(1.0, 2000)])
}
