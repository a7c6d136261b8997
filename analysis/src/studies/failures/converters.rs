//! What a linear analysis in real numbers does not see: steps of the arithmetic and of the encoder.

use firmware::certificate::Resolution;
use firmware::number::{Arithmetic, Format};
use firmware::scene::Scene;
use firmware::servo::Transducers;

use super::case::{FailureError, Study};
use super::claim::Claim;
use super::fate::End;
use super::setting::{PADDLE, PADDLES, coupled, friction_for_rest, trial, wall_of};
use super::trial::Trial;
use crate::simulation::torque_signal::TorqueSignal;
use crate::simulation::{Experiment, Integration};

/// Torque in N m with which the hand leans on the wall.
const LEANS: f64 = 0.2;
/// Samples of a trial.
const SAMPLES: usize = 5000;

/// Fixed point with 16 bits behind the point, on a device without friction.
pub fn fixed_point() -> Result<Study, FailureError> {
    let scene = paper();
    // Encoder and converter as fine as they get: their steps hum, too.
    let counts_per_turn = f64::from(1 << 22);
    let fine = Transducers { counts_per_turn, full_scale_torque: 0.3, ..PADDLES };
    let format = Format::Fixed { fraction_bits: 16 };
    let certificate = Claim::at_rest(&scene, format, &Resolution::of(&fine, Some(0.0)));
    let trial = |what, friction, expected| Trial {
        arithmetic: Arithmetic::I16F16,
        ..leaning(what, &scene, fine, expected, friction)
    };
    let hums = trial("no friction", 0.0, End::Hums);
    let needed = certificate.figure.unwrap_or_default();
    let rests = trial("the friction that it asks for", needed, End::Rests);
    let truth = Claim::simulated("simulation in Q16.16", &hums)?;
    Ok(Study { claims: ideal(&scene)?, certificate, truth, trials: vec![hums, rests] })
}

/// The encoder's steps, without friction and with as much as section 8 asks for.
pub fn encoder() -> Result<Study, FailureError> {
    let scene = paper();
    let needed = friction_for_rest(&scene, &PADDLES);
    let steps = Resolution::of(&PADDLES, Some(0.0));
    let certificate = Claim::at_rest(&scene, Format::F32, &steps);
    let hums = leaning("no friction", &scene, PADDLES, End::Hums, 0.0);
    let rests = leaning("K Delta/2 + B Delta/T of friction", &scene, PADDLES, End::Rests, needed);
    let truth = Claim::simulated("simulation with the encoder", &hums)?;
    Ok(Study { claims: ideal(&scene)?, certificate, truth, trials: vec![hums, rests] })
}

/// The paper's wall.
fn paper() -> Scene {
    coupled(PADDLE, wall_of(22.0, 0.01, 1))
}

fn leaning(
    what: &'static str,
    scene: &Scene,
    transducers: Transducers,
    expected: End,
    friction: f64,
) -> Trial {
    let mut trial = trial(what, scene, transducers, expected).pushed(0.0, SAMPLES);
    trial.experiment.friction = friction;
    trial.experiment.hand_torque = TorqueSignal::Held(vec![LEANS; SAMPLES]);
    trial.experiment.encoder_step = Some(std::f64::consts::TAU / transducers.counts_per_turn);
    trial
}

/// The loop without steps: its eigenvalues, and its simulation.
fn ideal(scene: &Scene) -> Result<Vec<Claim>, FailureError> {
    let mut smooth = leaning("no steps", scene, PADDLES, End::Rests, 0.0);
    smooth.experiment.encoder_step = None;
    Ok(vec![
        Claim::eigenvalues("linear analysis", &Experiment::still(scene), Integration::default())?,
        Claim::simulated("simulation in real numbers", &smooth)?,
    ])
}
