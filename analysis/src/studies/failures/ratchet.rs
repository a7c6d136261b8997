//! A torque profile that is a motor: its slopes are small, and its mean is not zero.

use std::f64::consts::TAU;

use haptic_servo::environment::{Environment, Profile, Shape, ShapeError};

use super::method_result::MOVES;
use super::setting::*;
use crate::device::Hand;
use crate::simulation::{Integration, simulate};

const TEETH: u32 = 24;
/// Mean torque in N m.
const MEAN: f64 = 3.0;
/// Amplitude of its torque in N m.
const SWING: f64 = 2.0;
/// Initial velocity in rad/s.
const TURNED: f64 = 6.0;
/// The angle in rad of the end stops, which are never reached.
const FAR: f64 = 100.0;
/// Stiffness in N m/rad of the end stops, and of the hand that holds the knob: more than the steepest fall.
const STIFFNESS: f64 = 50.0;
/// Damping in N m s/rad of that hand.
const DAMPING: f64 = 0.5;
/// Knots of a tooth, and of a tooth without the mean.
const TOOTH: [(f64, f64); 5] = tooth(MEAN);
const LEVEL_TOOTH: [(f64, f64); 5] = tooth(0.0);

/// In a hand that holds it, the knob rests; let go, it turns for ever.
pub fn ratchet() -> Result<CaseReport, StudyError> {
    let turns = turning("let go", &TOOTH, Outcome::Diverges)?;
    let rests = turning("the same less its mean", &LEVEL_TOOTH, Outcome::Converges)?;
    let hand = Hand { stiffness: STIFFNESS, damping: DAMPING, ..Hand::default() };
    let mut held = turns.experiment.clone();
    held.plant = held.plant.with_hand(hand);
    let positions = simulate(&held, Integration::default())?.position;
    let held = Motion::of(&positions, held.samples);
    let methods = vec![
        by_slopes(&turns.experiment.scene),
        MethodResult::of_motion("simulation in a hand that holds it", &held, MOVES),
    ];
    let reason = "let go, it turns on by {} rad in the last tenth of the run";
    let truth = MethodResult::of_motion("exact exponential", &turns.simulated()?, reason);
    let certificate = match profile(&[Shape::Periodic(&TOOTH)]) {
        Err(refused @ ShapeError::Mean { mean }) => {
            MethodResult::new("certificate", MethodVerdict::Unsafe, mean, &refused.to_string())
        }
        Err(refused) => return Err(refused.into()),
        Ok(profile) => MethodResult::certificate(&rigid(KNOB, profile)),
    };
    CaseReport::with(methods, certificate, truth, &[turns, rests])
}

/// Teeth of a knob between distant end stops.
fn turning(
    what: &'static str,
    tooth: &'static [(f64, f64)],
    expected: Outcome,
) -> Result<LoopRun, StudyError> {
    let ends = Shape::end_stops(-FAR, FAR, STIFFNESS);
    let scene = rigid(KNOB, profile(&[Shape::Periodic(tooth), ends])?);
    let mut loop_run = loop_run(what, &scene, KNOBS, expected).pushed(TURNED, 6000);
    // No board has its table, so there are no steps that friction must compensate.
    loop_run.experiment.friction = 0.0;
    Ok(loop_run)
}

/// Shapes as an environment of 16 knots, a sample late.
fn profile(shapes: &[Shape]) -> Result<Environment, ShapeError> {
    let units = Box::leak(vec![0; 16].into_boxed_slice());
    Ok(Profile::sampled(shapes, units, 1)?.alone())
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

/// The verdict by the slopes alone: `T (L/2 + M)` for a torque that is a sample late.
fn by_slopes(scene: &Scene) -> MethodResult {
    let steepest = SWING * 4.0 * f64::from(TEETH) / TAU;
    let needed = 1.5 * PERIOD * steepest;
    let reason = "the slopes ask for {} N m s/rad";
    let verdict = MethodVerdict::of(needed < scene.device.damping);
    MethodResult::new("the steepest slopes", verdict, needed, reason)
}
