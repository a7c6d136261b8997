//! What a linear analysis in real numbers ignores: the steps of the encoder.

use haptic_servo::certificate::Resolution;
use haptic_servo::number::Format;

use super::setting::*;
use crate::simulation::torque_signal::TorqueSignal;

/// Torque in N m with which the hand leans on the wall.
const LEANS: f64 = 0.2;
/// Samples of a run.
const SAMPLES: usize = 5000;

/// The encoder's steps, without friction and with the friction that section 8 requires.
pub fn encoder() -> Result<CaseResult, StudyError> {
    let scene = coupled(PADDLE, wall_of(22.0, 0.01, 1));
    let needed = friction_for_rest(&scene, &PADDLES);
    let steps = Resolution::of(&PADDLES, Some(0.0));
    let certificate = MethodResult::at_rest(&scene, Format::F32, &steps);
    let hums = leaning("no friction", &scene, Outcome::LimitCycles, 0.0);
    let rests = leaning("K Delta/2 + B Delta/T of friction", &scene, Outcome::Converges, needed);
    let truth = MethodResult::simulated("simulation with the encoder", &hums)?;
    let mut smooth = leaning("no steps", &scene, Outcome::Converges, 0.0);
    smooth.experiment.encoder_step = None;
    let linear = MethodResult::in_no_hand(&scene)?;
    let methods = vec![
        MethodResult { method: "linear analysis".into(), ..linear },
        MethodResult::simulated("simulation in real numbers", &smooth)?,
    ];
    Ok(CaseResult { methods, certificate, truth, runs: vec![hums, rests] })
}

fn leaning(what: &'static str, scene: &Scene, expected: Outcome, friction: f64) -> LoopRun {
    let mut loop_run = loop_run(what, scene, PADDLES, expected).pushed(0.0, SAMPLES);
    loop_run.experiment.friction = friction;
    loop_run.experiment.hand_torque = TorqueSignal::Held(vec![LEANS; SAMPLES]);
    loop_run.experiment.encoder_step = Some(std::f64::consts::TAU / PADDLES.counts_per_turn);
    loop_run
}
