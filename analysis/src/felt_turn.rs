//! The torque that a hand feels when it turns a torque profile: the codes of the servo as it would be
//! flashed, around a simulated device.

use std::f64::consts::TAU;

use haptic_servo::certificate::Rejection;
use haptic_servo::environment::{Ends, Profile};
use haptic_servo::scene::Scene;
use haptic_servo::servo::{BuildError, Transducers};
use thiserror::Error;

use crate::controller::{Tick, controller};
use crate::device::Hand;
use crate::hand::HandTrajectory;
use crate::identify::rig::torque_of;
use crate::lockstep::{SimulatedDevice, run};
use crate::profile_curve::ProfileCurve;
use crate::simulation::SimulationError;

#[derive(Debug, Error)]
pub enum FeltTurnError {
    #[error("the scene has no torque profile")]
    NoProfile,
    #[error("{0}")]
    Rejected(Box<Rejection>),
    #[error(transparent)]
    Servo(#[from] BuildError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// Two fingers around a knob: softer than its detents, so that they snap.
pub const FINGERS: Hand = Hand { inertia: 1e-5, damping: 0.002, stiffness: 0.4 };
/// Repetitions of a profile that are turned through.
pub const REPETITIONS: f64 = 3.0;
/// Times in s at which the hand starts, at which it arrives, and at which the turn ends.
const TIMES: [f64; 3] = [0.2, 1.6, 2.0];
/// Factor by which a profile that does not repeat is turned beyond its end.
const BEYOND: f64 = 1.05;

/// A turn, a sample a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct FeltTurn {
    pub time: Vec<f64>,
    /// Angle in rad, as the encoder counts it.
    pub angle: Vec<f64>,
    /// Set-point of the hand in rad.
    pub setpoint: Vec<f64>,
    /// Torque in N m that pushes back, of the code of each tick.
    pub torque: Vec<f64>,
    /// The profile, over the angles of the turn.
    pub curve: ProfileCurve,
}

impl FeltTurn {
    /// Turns a scene's device slowly from 0 rad on, through three repetitions, or to the upper end of a
    /// profile that does not repeat. The servo computes in `f32`.
    pub fn of(scene: &Scene, transducers: &Transducers, hand: Hand) -> Result<Self, FeltTurnError> {
        let profile = scene.environment.profile().ok_or(FeltTurnError::NoProfile)?;
        let way = way(profile);
        let certified = scene.certify().map_err(|why| FeltTurnError::Rejected(Box::new(why)))?;
        let mut servo = controller::<_, f32>(&certified, transducers)?;
        let description = "a hand turns it";
        let path = vec![(TIMES[0], 0.0), (TIMES[1], way), (TIMES[2], way)];
        let trajectory = HandTrajectory { description, hand, path, release: f64::INFINITY };
        let mut device = SimulatedDevice::new(scene, trajectory.clone(), transducers)?;
        let ticks = (TIMES[2] / scene.timing.period).ceil() as usize;
        let around = 0.5 * way / REPETITIONS;
        let curve = ProfileCurve::over(scene, &(-around..way + around));
        let curve = curve.ok_or(FeltTurnError::NoProfile)?;
        let run = run(&mut device, servo.as_mut(), ticks);
        let time: Vec<f64> = (0..ticks).map(|tick| tick as f64 * scene.timing.period).collect();
        let angle = |tick: &Tick| tick.count as f64 * TAU / transducers.counts_per_turn;
        // The motor applies the code, and a torque that pushes back is minus that.
        let torque = |tick: &Tick| -torque_of(tick.code, transducers.full_scale_torque);
        Ok(Self {
            angle: run.ticks.iter().map(angle).collect(),
            setpoint: time.iter().map(|time| trajectory.position(*time)).collect(),
            torque: run.ticks.iter().map(torque).collect(),
            time,
            curve,
        })
    }
}

/// How far a profile is turned in rad.
fn way(profile: &Profile) -> f64 {
    match profile.ends {
        Some(Ends { from, to, .. }) if !profile.outline().wraps => {
            BEYOND * if to > 0.0 { to } else { to - from }
        }
        _ => REPETITIONS * TAU / profile.count,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::knob;

    /// The tolerance is for DAC steps, and for half an encoder step on the slope.
    #[test]
    fn what_is_felt_is_the_profile_where_it_was_a_sample_ago() {
        let scene = knob::SCENE;
        let turn = FeltTurn::of(&scene, &knob::TRANSDUCERS, FINGERS).unwrap();
        assert_eq!(turn.time.len(), 2000);
        // The torque as a triangle wave, by an independent formula.
        let wave = |x: f64| 0.05 * std::f64::consts::FRAC_2_PI * (24.0 * x).sin().asin();
        let step = knob::TRANSDUCERS.full_scale_torque / 1791.0;
        // Behind the coupling the environment's position is the device's less the coupling's deflection.
        for tick in 1..2000 {
            let x = turn.angle[tick - 1] - turn.torque[tick - 1] / 44.0;
            let off = (turn.torque[tick] - wave(x)).abs();
            assert!(off < 2.0 * step + 1e-3, "{tick}: {off}");
        }
        let peaks = turn.torque.windows(2).filter(|two| two[0] > 0.0 && two[1] <= 0.0).count();
        assert!(peaks >= 3, "{peaks} tops");
        let end = turn.angle[1999];
        assert!((end - REPETITIONS * TAU / 24.0).abs() < 0.02, "{end}");
    }
}
