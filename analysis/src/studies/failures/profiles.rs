//! Torque profiles: detents that rest in a simulation and oscillate on a board, and a profile that is a
//! motor.

use std::f64::consts::TAU;

use haptic_servo::environment::{Environment, Profile, Shape, ShapeError};
use haptic_servo::scene::Timing;

use super::method_result::MOVES;
use super::setting::*;
use crate::device::Hand;
use crate::simulation::method::Method;
use crate::simulation::{Experiment, Integration, simulate};

/// Detents in a turn.
pub const DETENTS: u32 = 120;
/// Torque in N m of the oscillating detents.
pub const HUMMING: f64 = 0.25;
/// Torque in N m of the certified detents.
pub const CERTIFIED: f64 = 0.19;
/// Initial velocity in rad/s over the detents.
const SPEED: f64 = 20.0;
/// Steps per tick of a simulation without hold.
const FINE: u32 = 20;

/// Teeth of a ratchet in a turn.
pub const TEETH: u32 = 24;
/// Mean torque in N m of the ratchet.
pub const MEAN: f64 = 3.0;
/// Amplitude of its torque in N m.
pub const SWING: f64 = 2.0;
/// Initial velocity of the ratchet in rad/s.
const TURNED: f64 = 6.0;
/// The angle in rad of the end stops for the ratchet's simulation.
const FAR: f64 = 100.0;
/// Stiffness in N m/rad of the end stops, and of the hand that holds the ratchet: more than the ratchet's
/// steepest fall.
const STIFFNESS: f64 = 50.0;
/// Damping in N m s/rad of that hand.
const DAMPING: f64 = 0.5;
/// Knots of a tooth, and of a tooth without the mean.
const TOOTH: [(f64, f64); 5] = tooth(MEAN);
const LEVEL_TOOTH: [(f64, f64); 5] = tooth(0.0);

/// Detents that are simulated without hold and delay; with a held torque, a sample late, they do not rest.
pub fn fine_detents() -> Result<CaseResult, StudyError> {
    let hums = detents("0.25 N m", HUMMING, 1, PERIOD, Outcome::LimitCycles)?;
    let hums = hums.with_claimed_passivity(2.0);
    let rests = detents("0.19 N m", CERTIFIED, 1, PERIOD, Outcome::Converges)?;
    let at_once = detents("at once", HUMMING, 0, PERIOD, Outcome::Converges)?;
    let not_held = detents("not held", HUMMING, 0, PERIOD / f64::from(FINE), Outcome::Converges)?;
    let euler = Integration { method: Method::SemiImplicit, substeps: 1 };
    let methods = vec![
        rests_by("semi-implicit Euler, 1 step a tick", &at_once.experiment, euler)?,
        rests_by("torque neither held nor late", &not_held.experiment, Integration::default())?,
    ];
    let truth = MethodResult::simulated("exact exponential", &hums)?;
    let scene = hums.experiment.scene;
    Ok(CaseResult::of(&scene, methods, truth, [hums, rests]))
}

/// A profile whose slopes are all small, and whose mean is not zero.
pub fn ratchet() -> Result<CaseResult, StudyError> {
    let turns = turning("let go", &TOOTH, Outcome::Diverges)?;
    let rests = turning("the same less its mean", &LEVEL_TOOTH, Outcome::Converges)?;
    let hand = Hand { stiffness: STIFFNESS, damping: DAMPING, ..Hand::default() };
    let mut held = turns.experiment.clone();
    held.plant = held.plant.with_hand(hand);
    let methods = vec![
        by_slopes(&turns.experiment.scene),
        rests_by("simulation in a hand that holds it", &held, Integration::default())?,
    ];
    let reason = "let go, it turns on by {} rad in the last tenth of the run";
    let truth = MethodResult::of_motion("exact exponential", &turns.simulated()?, reason);
    let certificate = match profile(&[Shape::Periodic(&TOOTH)], 1) {
        Err(refused @ ShapeError::Mean { mean }) => {
            MethodResult::new("certificate", MethodVerdict::Unsafe, mean, &refused.to_string())
        }
        Err(refused) => return Err(refused.into()),
        Ok(profile) => MethodResult::certificate(&rigid(KNOB, profile)),
    };
    Ok(CaseResult { methods, certificate, truth, runs: vec![turns, rests] })
}

/// The detents of a rigid paddle with an initial velocity.
fn detents(
    what: &'static str,
    torque: f64,
    delay: usize,
    period: f64,
    expected: Outcome,
) -> Result<LoopRun, StudyError> {
    let environment = profile(&[Shape::detents(DETENTS, torque)], delay)?;
    let timing = Timing { period, worst_period: None };
    let scene = Scene { timing, ..rigid(PADDLE, environment) };
    let samples = (4.0 / period).round() as usize;
    Ok(loop_run(what, &scene, PADDLES, expected).pushed(SPEED, samples))
}

/// Teeth of a knob between distant end stops, which are never reached.
fn turning(
    what: &'static str,
    tooth: &'static [(f64, f64)],
    expected: Outcome,
) -> Result<LoopRun, StudyError> {
    let ends = Shape::end_stops(-FAR, FAR, STIFFNESS);
    let scene = rigid(KNOB, profile(&[Shape::Periodic(tooth), ends], 1)?);
    let mut loop_run = loop_run(what, &scene, KNOBS, expected).pushed(TURNED, 6000);
    // No board has its table, so there are no steps that friction must compensate.
    loop_run.experiment.friction = 0.0;
    Ok(loop_run)
}

/// Shapes as an environment, of 16 knots.
fn profile(shapes: &[Shape], delay: usize) -> Result<Environment, ShapeError> {
    let units = Box::leak(vec![0; 16].into_boxed_slice());
    Ok(Profile::sampled(shapes, units, delay)?.alone())
}

/// A tooth: a torque that swings about a mean.
const fn tooth(mean: f64) -> [(f64, f64); 5] {
    let quarter = TAU / TEETH as f64 / 4.0;
    [
        (0.0, mean),
        (quarter, mean + SWING),
        (2.0 * quarter, mean),
        (3.0 * quarter, mean - SWING),
        (4.0 * quarter, mean),
    ]
}

/// The verdict of a simulation with its own integration.
fn rests_by(
    method: &str,
    experiment: &Experiment,
    integration: Integration,
) -> Result<MethodResult, StudyError> {
    let positions = simulate(experiment, integration)?.position;
    Ok(MethodResult::of_motion(method, &Motion::of(&positions, experiment.samples), MOVES))
}

/// The verdict by the slopes alone: `T (L/2 + M)` for a torque that is a sample late.
fn by_slopes(scene: &Scene) -> MethodResult {
    let steepest = SWING * 4.0 * f64::from(TEETH) / TAU;
    let needed = 1.5 * PERIOD * steepest;
    let reason = "the slopes ask for {} N m s/rad";
    let verdict = MethodVerdict::of(needed < scene.device.damping);
    MethodResult::new("the steepest slopes", verdict, needed, reason)
}
