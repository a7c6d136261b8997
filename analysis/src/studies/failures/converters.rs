//! The effects that a linear analysis in real numbers ignores: steps of the arithmetic and of the encoder.

use haptic_servo::certificate::Resolution;
use haptic_servo::number::{Arithmetic, Format};
use haptic_servo::servo::Transducers;

use super::setting::*;
use crate::simulation::torque_signal::TorqueSignal;

/// Torque in N m with which the hand leans on the wall.
const LEANS: f64 = 0.2;
/// Samples of a run.
const SAMPLES: usize = 5000;

/// Fixed point with 16 fractional bits, on a device without friction.
pub fn fixed_point() -> Result<CaseResult, StudyError> {
    let scene = paper();
    // The finest encoder and DAC: their steps cause limit cycles, too.
    let counts_per_turn = f64::from(1 << 22);
    let fine = Transducers { counts_per_turn, full_scale_torque: 0.3, ..PADDLES };
    let format = Format::Fixed { fraction_bits: 16 };
    let certificate = MethodResult::at_rest(&scene, format, &Resolution::of(&fine, Some(0.0)));
    let loop_run = |what, friction, expected| LoopRun {
        arithmetic: Arithmetic::I16F16,
        ..leaning(what, &scene, fine, expected, friction)
    };
    let hums = loop_run("no friction", 0.0, Outcome::LimitCycles);
    let needed = certificate.figure.unwrap_or_default();
    let rests = loop_run("the friction that it asks for", needed, Outcome::Converges);
    let truth = MethodResult::simulated("simulation in Q16.16", &hums)?;
    Ok(CaseResult { methods: ideal(&scene)?, certificate, truth, runs: vec![hums, rests] })
}

/// The encoder's steps, without friction and with the friction that section 8 requires.
pub fn encoder() -> Result<CaseResult, StudyError> {
    let scene = paper();
    let needed = friction_for_rest(&scene, &PADDLES);
    let steps = Resolution::of(&PADDLES, Some(0.0));
    let certificate = MethodResult::at_rest(&scene, Format::F32, &steps);
    let hums = leaning("no friction", &scene, PADDLES, Outcome::LimitCycles, 0.0);
    let rests =
        leaning("K Delta/2 + B Delta/T of friction", &scene, PADDLES, Outcome::Converges, needed);
    let truth = MethodResult::simulated("simulation with the encoder", &hums)?;
    Ok(CaseResult { methods: ideal(&scene)?, certificate, truth, runs: vec![hums, rests] })
}

/// The paper's wall.
fn paper() -> Scene {
    coupled(PADDLE, wall_of(22.0, 0.01, 1))
}

fn leaning(
    what: &'static str,
    scene: &Scene,
    transducers: Transducers,
    expected: Outcome,
    friction: f64,
) -> LoopRun {
    let mut loop_run = loop_run(what, scene, transducers, expected).pushed(0.0, SAMPLES);
    loop_run.experiment.friction = friction;
    loop_run.experiment.hand_torque = TorqueSignal::Held(vec![LEANS; SAMPLES]);
    loop_run.experiment.encoder_step = Some(std::f64::consts::TAU / transducers.counts_per_turn);
    loop_run
}

/// The loop without steps: its eigenvalues, and its simulation.
fn ideal(scene: &Scene) -> Result<Vec<MethodResult>, StudyError> {
    let mut smooth = leaning("no steps", scene, PADDLES, Outcome::Converges, 0.0);
    smooth.experiment.encoder_step = None;
    let linear = MethodResult::in_no_hand(scene)?;
    Ok(vec![
        MethodResult { method: "linear analysis".into(), ..linear },
        MethodResult::simulated("simulation in real numbers", &smooth)?,
    ])
}
