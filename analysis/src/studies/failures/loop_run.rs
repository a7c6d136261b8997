//! A run of a loop: simulated without quantisation, and on the emulated board with it.

use firmware_harness::loop_request::{LoopRequest, StartReply};
use firmware_harness::tables::index_of;
use haptic_servo::certificate::{Certified, Rejection};
use haptic_servo::environment::Environment;
use haptic_servo::number::Arithmetic;
use haptic_servo::scene::{Device, Scene};
use haptic_servo::servo::Transducers;
use serde::Serialize;

use super::loaded::LoadedDevice;
use super::method_result::{MOVES, MethodResult};
use super::motion::{Motion, Outcome};
use crate::controller::controller;
use crate::emulator::Client;
use crate::lockstep::run;
use crate::simulation::{Experiment, Integration, simulate};
use crate::studies::error::StudyError;

/// A loop to run.
#[derive(Clone, Debug)]
pub struct LoopRun {
    /// The run as short text.
    pub what: &'static str,
    /// Scene, device, hand, friction, missed ticks.
    pub experiment: Experiment,
    /// Encoder and motor of the board.
    pub transducers: Transducers,
    /// The device in the board's scene, in place of the true one: with more damping and passivity, because
    /// otherwise a board does not run a rejected scene.
    pub claimed: Option<Device>,
    /// The expected outcome.
    pub expected: Outcome,
}

/// The result of a scene on a board.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BoardResult {
    /// The board does not run it with any claimed device.
    Refused,
    /// The board ran it, and all codes equal those of the same servo on the host.
    Ran(Motion),
}

impl BoardResult {
    /// Whether this is the expected outcome; a refusal prevents divergence.
    pub fn agrees_with(&self, expected: Outcome) -> bool {
        match self {
            Self::Refused => expected != Outcome::Converges,
            Self::Ran(motion) => motion.outcome() == expected,
        }
    }
}

impl LoopRun {
    /// The motion of the loop in `f64`, with only the experiment's quantisation.
    pub fn simulated(&self) -> Result<Motion, StudyError> {
        let positions = simulate(&self.experiment, Integration::default())?.position;
        Ok(Motion::of(&positions, self.experiment.samples))
    }

    /// The motion of the loop with the emulated board as the servo. The board is compared with the servo on
    /// this machine in every tick.
    pub fn emulated(&self, player: &mut Client) -> Result<BoardResult, StudyError> {
        let request = self.request();
        let (reply, here) = (player.start(&request)?, self.certified());
        let certified = match (reply, here) {
            (StartReply::Ready, Ok(certified)) => certified,
            (StartReply::Rejected, Err(_)) => return Ok(BoardResult::Refused),
            (reply, _) => return Err(StudyError::Disagreement(format!("{reply:?}"))),
        };
        let mut servo = controller::<Environment, f32>(&certified, &self.transducers)?;
        let mut device = LoadedDevice::new(&self.experiment, &self.transducers)?;
        let ticks = request.ticks as usize;
        let run = run(&mut device, servo.as_mut(), Some(player), ticks, || {})?;
        match run.difference {
            Some(difference) => Err(StudyError::Disagreement(difference.to_string())),
            None => Ok(BoardResult::Ran(Motion::of(&device.positions, self.experiment.samples))),
        }
    }

    /// Whether the emulated board can run the scene: torque profiles only with its own tables.
    pub fn goes_to_a_board(&self) -> bool {
        let profile = self.experiment.scene.environment.profile();
        profile.is_none_or(|profile| index_of(profile).is_some())
    }

    /// The scene for the board, with the claimed device.
    pub fn scene_for_board(&self) -> Scene {
        let scene = self.experiment.scene;
        Scene { device: self.claimed.unwrap_or(scene.device), ..scene }
    }

    fn certified(&self) -> Result<Certified<Scene>, StudyError> {
        let refused = |rejection: Rejection| StudyError::Disagreement(rejection.to_string());
        self.scene_for_board().certify().map_err(refused)
    }

    fn request(&self) -> LoopRequest {
        LoopRequest {
            scene: self.scene_for_board(),
            transducers: self.transducers,
            arithmetic: Arithmetic::F32,
            ticks: self.ticks() as u32,
        }
    }

    /// The number of ticks that are not missed.
    fn ticks(&self) -> usize {
        let Experiment { missed, samples, .. } = &self.experiment;
        missed.ticks().take(*samples).filter(|is_missed| !is_missed).count()
    }
}

impl MethodResult {
    /// The verdict of a simulation.
    pub fn simulated(method: &str, loop_run: &LoopRun) -> Result<Self, StudyError> {
        Ok(Self::of_motion(method, &loop_run.simulated()?, MOVES))
    }
}
