//! A passivity observer and controller as they are written in the literature, at a velocity of
//! zero.
//!
//! The observer sums up the energy that the environment has taken, `W += F(k-1) (x(k) - x(k-1))`;
//! where `W` is negative the controller adds the damping `-W / (T v^2)` that is to bring it back to
//! zero. Between two counts of the encoder `v` is zero.

use std::f64::consts::TAU;

use firmware::scene::Scene;
use firmware::torque::LimitReason;

use super::case::{FailureError, Study};
use super::claim::{Claim, Says};
use super::fate::{End, Fate};
use super::loaded::LoadedDevice;
use super::setting::{PADDLE, PADDLES, PERIOD, coupled, trial, wall_of};
use super::trial::Trial;
use crate::simulation::SimulationError;
use crate::simulation::torque_signal::TorqueSignal;
use crate::simulation::unquantized_servo::UnquantizedServo;

/// Samples of the trial.
const SAMPLES: usize = 4000;
/// Torque in N m with which the hand leans on the wall.
const LEANS: f64 = 0.2;

/// A wall that needs no observer, under two of them.
pub fn passivity_observer() -> Result<Study, FailureError> {
    let scene = coupled(PADDLE, wall_of(20.0, 0.0, 1));
    let mut ours = trial("the certified wall", &scene, PADDLES, End::Rests).pushed(0.0, SAMPLES);
    // Slowly in and out, far less than a count a tick.
    let part = |sample: usize| sample as f64 / (SAMPLES / 4) as f64;
    let lean = |sample| LEANS * part(sample).min(2.0 - part(sample)).max(0.0);
    ours.experiment.hand_torque = TorqueSignal::Held((0..SAMPLES).map(lean).collect());
    let claims = vec![
        observed(&scene, &ours, "passivity observer", Divide::Always)?,
        observed(&scene, &ours, "the same, not at v = 0", Divide::WhereItMoves)?,
    ];
    let fate = ours.simulated()?;
    let because = "left alone, the device ends within {} rad";
    let says = Says::of(fate.end() == End::Rests);
    let truth = Claim::new("exact exponential", says, fate.last, because);
    Ok(Study { claims, certificate: Claim::certificate(&scene), truth, trials: vec![ours] })
}

/// When the controller divides by the velocity.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Divide {
    Always,
    WhereItMoves,
}

/// The wall with the observer around it: what it asks the motor for.
fn observed(scene: &Scene, trial: &Trial, by: &str, divide: Divide) -> Result<Claim, FailureError> {
    let mut servo = UnquantizedServo::new(scene).map_err(SimulationError::from)?;
    let mut device = LoadedDevice::new(&trial.experiment, &PADDLES)?;
    let step = TAU / PADDLES.counts_per_turn;
    let (mut energy, mut last, mut held, mut peak) = (0.0, 0.0, 0.0, 0.0_f64);
    for sample in 0..trial.experiment.samples {
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
            let because = "the torque is not a number from {} s on";
            return Ok(Claim::new(by, Says::Unsafe, sample as f64 * PERIOD, because));
        }
        peak = peak.max(held.abs());
        held = held.clamp(-PADDLES.full_scale_torque, PADDLES.full_scale_torque);
        device.apply(-held);
    }
    let fate = Fate::of(&device.positions, trial.experiment.samples);
    let because = format!("{}; it asks the motor for {{}} N m", fate);
    Ok(Claim::new(by, Says::of(fate.end() == End::Rests), peak, &because))
}
