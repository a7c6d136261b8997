//! A run of a loop: simulated without quantisation, and with the servo of a board.

use haptic_servo::environment::Environment;
use haptic_servo::scene::{Device, Scene};
use haptic_servo::servo::Transducers;

use super::loaded::LoadedDevice;
use super::motion::{Motion, Outcome};
use crate::controller::controller;
use crate::lockstep::run;
use crate::simulation::{Experiment, Integration, simulate};
use crate::studies::error::StudyError;

/// A loop to run.
#[derive(Clone, Debug)]
pub struct LoopRun {
    /// The run as short text.
    pub what: &'static str,
    /// Scene, device, hand and friction.
    pub experiment: Experiment,
    /// Encoder and motor of the board.
    pub transducers: Transducers,
    /// The device in the board's scene, in place of the true one: with more damping and passivity, because
    /// otherwise a board does not run a rejected scene.
    pub claimed: Option<Device>,
    /// The expected outcome.
    pub expected: Outcome,
}

impl LoopRun {
    /// The motion of the loop in `f64`, with only the experiment's quantisation.
    pub fn simulated(&self) -> Result<Motion, StudyError> {
        let positions = simulate(&self.experiment, Integration::default())?.position;
        Ok(Motion::of(&positions, self.experiment.samples))
    }

    /// The motion of the loop with the servo as a board runs it: in `f32`, between encoder and DAC. `None` for a
    /// torque profile, whose table no board has, and for a scene that a board refuses whatever its device.
    pub fn with_servo(&self) -> Result<Option<Motion>, StudyError> {
        let Experiment { scene, samples, .. } = &self.experiment;
        if scene.environment.profile().is_some() {
            return Ok(None);
        }
        let claimed = Scene { device: self.claimed.unwrap_or(scene.device), ..*scene };
        let Ok(certified) = claimed.certify() else { return Ok(None) };
        let mut servo = controller::<Environment, f32>(&certified, &self.transducers)?;
        let mut device = LoadedDevice::new(&self.experiment, &self.transducers)?;
        run(&mut device, servo.as_mut(), *samples);
        Ok(Some(Motion::of(&device.positions, *samples)))
    }
}
