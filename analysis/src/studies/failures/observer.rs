//! A passivity observer and controller, as in the literature, at a velocity of zero.
//!
//! The observer sums the energy that the environment has taken, `W += F(k-1) (x(k) - x(k-1))`; if `W` is
//! negative the controller adds the damping `-W / (T v^2)` to bring it back to zero. Between two counts of
//! the encoder `v` is zero.

use std::f64::consts::TAU;

use haptic_servo::torque::LimitReason;

use super::setting::*;
use crate::simulation::SimulationError;
use crate::simulation::torque_signal::TorqueSignal;
use crate::simulation::unquantized_servo::UnquantizedServo;

/// Samples of the run.
const SAMPLES: usize = 4000;
/// Torque in N m with which the hand leans on the wall.
const LEANS: f64 = 0.2;

/// A wall that needs no observer, with two observers.
pub fn passivity_observer() -> Result<CaseResult, StudyError> {
    let scene = coupled(PADDLE, wall_of(20.0, 0.0, 1));
    let mut ours =
        loop_run("the certified wall", &scene, PADDLES, Outcome::Converges).pushed(0.0, SAMPLES);
    // Slowly in and out, by far less than a count per tick.
    let part = |sample: usize| sample as f64 / (SAMPLES / 4) as f64;
    let lean = |sample| LEANS * part(sample).min(2.0 - part(sample)).max(0.0);
    ours.experiment.hand_torque = TorqueSignal::Held((0..SAMPLES).map(lean).collect());
    let methods = vec![
        observed(&scene, &ours, "passivity observer", Divide::Always)?,
        observed(&scene, &ours, "the same, not at v = 0", Divide::WhereItMoves)?,
    ];
    let reason = "left alone, the device ends within {} rad";
    let truth = MethodResult::of_motion("exact exponential", &ours.simulated()?, reason);
    Ok(CaseResult::of(&scene, methods, truth, [ours]))
}

/// When the controller divides by the velocity.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Divide {
    Always,
    WhereItMoves,
}

/// The motor torque of the wall with the observer around it.
fn observed(
    scene: &Scene,
    loop_run: &LoopRun,
    method: &str,
    divide: Divide,
) -> Result<MethodResult, StudyError> {
    let mut servo = UnquantizedServo::new(scene).map_err(SimulationError::from)?;
    let mut device = LoadedDevice::new(&loop_run.experiment, &PADDLES)?;
    let step = TAU / PADDLES.counts_per_turn;
    let (mut energy, mut last, mut held, mut peak) = (0.0, 0.0, 0.0, 0.0_f64);
    for sample in 0..loop_run.experiment.samples {
        let angle = (device.position() / step).floor() * step;
        let moved = angle - std::mem::replace(&mut last, angle);
        energy += held * moved;
        let (torque, _) = servo.tick(angle, LimitReason::None);
        let velocity = moved / PERIOD;
        let divides = divide == Divide::Always || velocity != 0.0;
        let damping = match energy < 0.0 && divides {
            true => -energy / (PERIOD * velocity * velocity),
            false => 0.0,
        };
        held = torque + damping * velocity;
        if !held.is_finite() {
            let (time, reason) =
                (sample as f64 * PERIOD, "the torque is not a number from {} s on");
            return Ok(MethodResult::new(method, MethodVerdict::Unsafe, time, reason));
        }
        peak = peak.max(held.abs());
        held = held.clamp(-PADDLES.full_scale_torque, PADDLES.full_scale_torque);
        device.apply(-held);
    }
    let motion = Motion::of(&device.positions, loop_run.experiment.samples);
    let reason = format!("{motion}; it asks the motor for {{}} N m");
    let verdict = MethodVerdict::of(motion.outcome() == Outcome::Converges);
    Ok(MethodResult::new(method, verdict, peak, &reason))
}
