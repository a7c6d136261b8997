//! A loop that is run: simulated without converters, and on the emulated board with them.

use firmware::certificate::{Certified, Rejection};
use firmware::environment::Environment;
use firmware::number::{Arithmetic, InEach, Number, OutOfRange};
use firmware::scene::{Device, Scene};
use firmware::servo::{BuildError, Transducers};
use firmware_harness::loop_request::{LoopRequest, StartReply};
use serde::Serialize;
use thiserror::Error;

use super::claim::{Claim, Says};
use super::fate::{End, Fate};
use super::loaded::LoadedDevice;
use crate::controller::{Controller, controller};
use crate::emulator::{EmulatorError, ServoClient};
use crate::lockstep::run;
use crate::simulation::{Experiment, Integration, SimulationError, simulate};

/// Why there is no proof.
#[derive(Debug, Error)]
pub enum TrialError {
    /// The loop cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The board failed.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The board refuses, or takes, what the host does not.
    #[error("host and board disagree on whether this scene may run: {0}")]
    Disagreement(String),
    /// The servo cannot be had in this arithmetic.
    #[error(transparent)]
    Servo(#[from] BuildError),
    /// The angle is more than this arithmetic holds.
    #[error(transparent)]
    Angle(#[from] OutOfRange),
}

/// A loop that is run.
#[derive(Clone, Debug)]
pub struct Trial {
    /// What is tried, in a few words.
    pub what: &'static str,
    /// Scene, device, hand, friction, missed ticks.
    pub experiment: Experiment,
    /// Encoder and motor of the board.
    pub transducers: Transducers,
    /// What the board computes in.
    pub arithmetic: Arithmetic,
    /// The device that the board is told of, in place of the scene's: one with more damping and
    /// passivity than it has, since no board can be made to run what is refused in any other way.
    pub claimed: Option<Device>,
    /// What will become of it.
    pub expected: End,
}

/// What a board did with a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Played {
    /// It does not run it, whatever device is claimed.
    Refused,
    /// It ran it, all its codes being those of the same servo on the host.
    Ran(Fate),
}

impl Played {
    /// Whether that is what was to come of a trial: a board that refuses lets nothing grow.
    pub fn shows(&self, expected: End) -> bool {
        match self {
            Self::Refused => expected != End::Rests,
            Self::Ran(fate) => fate.end() == expected,
        }
    }
}

impl Trial {
    /// What becomes of the loop in `f64`, without converters but for what the experiment has.
    ///
    /// # Errors
    /// Where it cannot be simulated.
    pub fn simulated(&self) -> Result<Fate, TrialError> {
        let positions = match self.arithmetic {
            Arithmetic::F32 => simulate(&self.experiment, Integration::default())?.position,
            _ => self.without_converters()?,
        };
        Ok(Fate::of(&positions, self.experiment.samples))
    }

    /// The same with the servo's own arithmetic.
    fn without_converters(&self) -> Result<Vec<f64>, TrialError> {
        let mut servo = self.controller(&self.certified()?)?;
        let mut device = LoadedDevice::new(&self.experiment, &self.transducers)?;
        while device.positions.len() < self.experiment.samples {
            let torque = servo.tick_at(device.position())?;
            device.apply(-torque);
        }
        device.positions.truncate(self.experiment.samples);
        Ok(device.positions)
    }

    /// What becomes of the loop of which the emulated board is the servo. The board is compared
    /// with the servo on this machine in every tick.
    ///
    /// # Errors
    /// Where the board fails, or disagrees with this machine.
    pub fn emulated(&self, player: &mut ServoClient) -> Result<Played, TrialError> {
        let request = self.request();
        let (reply, here) = (player.start(&request)?, self.certified());
        let certified = match (reply, here) {
            (StartReply::Ready, Ok(certified)) => certified,
            (StartReply::Rejected, Err(_)) => return Ok(Played::Refused),
            (reply, _) => return Err(TrialError::Disagreement(format!("{reply:?}"))),
        };
        let mut servo = self.controller(&certified)?;
        let mut device = LoadedDevice::new(&self.experiment, &self.transducers)?;
        let ticks = request.ticks as usize;
        let run = run(&mut device, servo.as_mut(), Some(player), ticks, || {})?;
        match run.difference {
            Some(difference) => Err(TrialError::Disagreement(difference.to_string())),
            None => Ok(Played::Ran(Fate::of(&device.positions, self.experiment.samples))),
        }
    }

    /// The scene as the board is told it.
    pub fn told(&self) -> Scene {
        let scene = self.experiment.scene;
        Scene { device: self.claimed.unwrap_or(scene.device), ..scene }
    }

    fn certified(&self) -> Result<Certified<Scene>, TrialError> {
        let refused = |rejection: Rejection| TrialError::Disagreement(rejection.to_string());
        self.told().certify().map_err(refused)
    }

    fn request(&self) -> LoopRequest {
        LoopRequest {
            scene: self.told(),
            transducers: self.transducers,
            arithmetic: self.arithmetic,
            ticks: self.ticks() as u32,
        }
    }

    /// Ticks that are not missed.
    fn ticks(&self) -> usize {
        let Experiment { missed, samples, .. } = &self.experiment;
        missed.ticks().take(*samples).filter(|is_missed| !is_missed).count()
    }

    fn controller(&self, certified: &Certified<Scene>) -> Result<Box<dyn Controller>, BuildError> {
        self.arithmetic.choose(Build { certified, transducers: &self.transducers })
    }
}

/// Builds a servo, in an arithmetic that is still to be chosen.
struct Build<'a> {
    certified: &'a Certified<Scene>,
    transducers: &'a Transducers,
}

impl InEach for Build<'_> {
    type Output = Result<Box<dyn Controller>, BuildError>;

    fn with<N: Number>(self) -> Self::Output {
        controller::<Environment, N>(self.certified, self.transducers)
    }
}

impl Claim {
    /// What becomes of a loop in simulation.
    ///
    /// # Errors
    /// Where it cannot be simulated.
    pub fn simulated(by: &str, trial: &Trial) -> Result<Self, TrialError> {
        let fate = trial.simulated()?;
        let says = Says::of(fate.end() == End::Rests);
        Ok(Self::new(by, says, fate.last, "at the end it moves to and fro by {} rad"))
    }
}
