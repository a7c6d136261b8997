//! A hand that moves back and forth over one edge of the encoder, in alternate ticks: the least friction that
//! keeps a wall passive is not less than that of section 8 of the theory.

use std::f64::consts::TAU;

use haptic_servo::certificate::Resolution;
use haptic_servo::number::Format;
use haptic_servo::torque::LimitReason;

use super::method_result::MOVES;
use super::setting::*;
use crate::simulation::SimulationError;
use crate::simulation::unquantized_servo::UnquantizedServo;

/// Number of cycles.
const TIMES: usize = 8;
/// Amplitude of the hand on both sides of the edge, in steps of the encoder.
const BESIDE: f64 = 0.1;
/// Fraction of the needed friction.
const ALMOST: f64 = 0.99;

/// A wall with almost the friction that it needs: without the hand it comes to rest.
pub fn zigzag() -> Result<CaseReport, StudyError> {
    let scene = wall();
    let needed = encoder_friction(&scene, &PADDLES);
    // With any DAC resolution.
    let steps = Resolution { full_scale: None, ..Resolution::of(&PADDLES, Some(ALMOST * needed)) };
    let certificate = MethodResult::at_rest(&scene, Format::F64, &steps);
    let mut rests = loop_run("in no hand", &scene, PADDLES, Outcome::Converges).pushed(1.0, 2000);
    rests.experiment.encoder_step = Some(TAU / PADDLES.counts_per_turn);
    rests.experiment.friction = ALMOST * needed;
    let moves = rests.simulated()?;
    let methods = vec![MethodResult::of_motion("simulation in no hand", &moves, MOVES)];
    let gained = gained(&scene, ALMOST * needed)?;
    let reason = "a hand that goes over one edge and back gets {} J out each time";
    let truth = MethodResult::new("zigzag", MethodVerdict::of(gained <= 0.0), gained, reason);
    CaseReport::with(methods, certificate, truth, &[rests])
}

/// The wall: neither delayed nor coupled, so that its torque is the encoder's step times its gains.
pub fn wall() -> Scene {
    rigid(PADDLE, wall_of(20.0, 0.005, 0))
}

/// Energy in J that a hand gains from a wall and its dry friction in each cycle over an edge of the encoder.
pub fn gained(scene: &Scene, friction: f64) -> Result<f64, StudyError> {
    let step = TAU / PADDLES.counts_per_turn;
    let mut servo = UnquantizedServo::new(scene).map_err(SimulationError::from)?;
    let mut work = [0.0; 2];
    for half in 0..2 * TIMES {
        // Below the edge, and on its way up; above it, and on its way down.
        let (count, sign) = if half % 2 == 0 { (-1.0, 1.0) } else { (0.0, -1.0) };
        let (torque, _) = servo.tick(count * step, LimitReason::None);
        let way = sign * 2.0 * BESIDE * step;
        work[half % 2] = -torque * way - friction * way.abs();
    }
    Ok(work.iter().sum())
}
