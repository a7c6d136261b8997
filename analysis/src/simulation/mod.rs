//! What a scene would do: the sampled loop of servo, device and hand, tick by tick.
//!
//! In tick `k` the servo reads the angle at `t = k T`, computes the coupling torque `F(k)`, and the
//! motor applies `-F(k)` until the next tick. Position, velocity and `F` are recorded at that
//! instant, before the torque acts. Environment and hidden states start at rest at zero. A scene
//! need not be certified to be simulated; that it need not is the use of a simulation.
//!
//! ```
//! use analysis::file::{Format, parse};
//! use analysis::simulation::{Experiment, Stride, simulate};
//!
//! let file = parse("bounce.toml", Format::Toml, r#"
//!     name = "bounce"
//!     device = { inertia = 2.2e-5, damping = 0.022 }
//!     servo = { period = 0.001 }
//!     coupling = { stiffness = 44.0 }
//!     environment = { type = "damper-wall", stiffness = 22.0, damping = 0.01, delay = 1 }
//!     simulation = { samples = 1000, position = 0.001 }
//! "#)?;
//! let motion = simulate(&Experiment::of(&file, ".".as_ref())?, Stride::default())?;
//! assert_eq!(motion.position[0], 0.001);
//! assert!(motion.position[999].abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod closed;
pub mod drive;
pub mod friction;
pub mod held;
pub mod kernel;
pub mod method;
pub mod plant;
pub mod rendering;
pub mod served;
pub mod tick;

mod general;

use std::path::Path;

use firmware::environment::{Environment, Wall};
use firmware::passivity::transfer::Unbuildable;
use firmware::scene::Scene;
use firmware::servo::BuildError;
use serde::Serialize;
use thiserror::Error;

use crate::device::Motion;
use crate::file::{FileError, SceneFile};
use crate::missed::Missed;
use crate::quantity::significant;

use closed::ClosedLoop;
use drive::Drive;
use general::General;
pub(crate) use general::Machine;
use kernel::Linear;
use method::Method;
use plant::Plant;
use served::Served;
use tick::{Stepping, Tick};

/// Why there is no answer.
#[derive(Debug, Error)]
pub enum SimulationError {
    /// The file does not say what to simulate.
    #[error("{scene}: a simulation needs a [simulation] table with `samples`")]
    NoSimulation {
        /// Name of the scene.
        scene: String,
    },
    /// The scene has no law that could run.
    #[error("the scene cannot run: {0}")]
    Servo(#[from] BuildError),
    /// The scene has no linear loop.
    #[error("the scene has no closed loop: {}", unbuildable(*.0))]
    Loop(Unbuildable),
    /// The torque file cannot be read.
    #[error("cannot read the torque file {file}: {error}")]
    TorqueFile {
        /// The file.
        file: String,
        /// Why.
        error: std::io::Error,
    },
    /// The torque file is not text.
    #[error(transparent)]
    TorqueText(Box<FileError>),
    /// Something in the torque file is not a finite number.
    #[error("{file}:{line}: `{value}` is out of bounds; it must be a finite number in N m")]
    TorqueValue {
        /// The file.
        file: String,
        /// The line, counted from 1.
        line: usize,
        /// What stands there.
        value: String,
    },
    /// The motion over a period is out of range.
    #[error(
        "the motion over a period of {period:e} s of a machine with rates of up to {rate:.1e} per \
         second is beyond the range of numbers; look at that period, and at the inertia, damping \
         and stiffness of device and hand"
    )]
    TooFast {
        /// Largest of the machine's rates in 1/s, or of their squares in 1/s^2.
        rate: f64,
        /// The period in s.
        period: f64,
    },
    /// The motion grows beyond the range of numbers.
    #[error(
        "the motion grows beyond the range of numbers: there is none from sample {sample} on, which \
         is at {} s; the loop is not stable (`haptic stability`)", significant(*.time, 6)
    )]
    Overflow {
        /// The first sample, counted from 0, of which something is no finite number.
        sample: usize,
        /// When that is in s.
        time: f64,
    },
    /// No eigenvalues were found.
    #[error("the eigenvalues of the closed loop were not found; its numbers are too far apart")]
    Eigenvalues,
}

impl From<Unbuildable> for SimulationError {
    fn from(error: Unbuildable) -> Self {
        Self::Loop(error)
    }
}

fn unbuildable(error: Unbuildable) -> &'static str {
    match error {
        Unbuildable::Improper => "its environment needs samples from the future",
        Unbuildable::IllPosed => "coupling and environment have no unique solution",
        Unbuildable::OutOfRange => "a number of it is out of range",
    }
}

/// Everything that decides what will happen.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The scene; its device is where the canceller's damping comes from.
    pub scene: Scene,
    /// The machine, with the hand that holds it and its amplifier's lag.
    pub plant: Plant,
    /// How the device moves at sample 0.
    pub start: Motion,
    /// Number of samples.
    pub samples: usize,
    /// Torque of the hand.
    pub drive: Drive,
    /// Angle of an encoder count in rad, if the angle is floored to whole counts.
    pub encoder_step: Option<f64>,
    /// Dry friction of the motor's mass in N m.
    pub friction: f64,
    /// Time in s from a sample to its torque, less than the period.
    pub latency: f64,
    /// Ticks in which the servo does not run.
    pub missed: Missed,
}

impl Experiment {
    /// What a scene file asks for; `folder` is where its torque file is looked for.
    ///
    /// # Errors
    /// Where the file has no `[simulation]`, or its torque file cannot be read.
    pub fn of(file: &SceneFile, folder: &Path) -> Result<Self, SimulationError> {
        let Some(simulation) = &file.simulation else {
            return Err(SimulationError::NoSimulation { scene: file.name.clone() });
        };
        Ok(Self {
            samples: simulation.samples,
            start: Motion { position: simulation.position, velocity: simulation.velocity },
            drive: Drive::load(
                &simulation.torque,
                folder,
                simulation.samples,
                file.scene.timing.period,
            )?,
            friction: simulation.friction,
            latency: simulation.latency,
            missed: simulation.missed,
            encoder_step: file.encoder_step,
            ..Self::at_rest(file)
        })
    }

    /// The scene and the machine of a file, at rest, with nothing to disturb them but latency.
    pub fn at_rest(file: &SceneFile) -> Self {
        Self {
            plant: Plant::of(&file.chain).held(file.hand.unwrap_or_default()),
            latency: file.simulation.as_ref().map_or(0.0, |simulation| simulation.latency),
            ..Self::still(&file.scene)
        }
    }

    /// A scene on its rigid device in no hand, at rest, with nothing to disturb it.
    pub fn still(scene: &Scene) -> Self {
        Self {
            scene: *scene,
            plant: Plant::rigid(scene.device),
            start: Motion::default(),
            samples: 0,
            drive: Drive::Free,
            encoder_step: None,
            friction: 0.0,
            latency: 0.0,
            missed: Missed::None,
        }
    }

    /// Whether `computed` samples are all that there should be.
    ///
    /// # Errors
    /// Where the motion has left the range of numbers before.
    pub fn completed(&self, computed: usize) -> Result<(), SimulationError> {
        if computed >= self.samples {
            return Ok(());
        }
        let time = computed as f64 * self.scene.timing.period;
        Err(SimulationError::Overflow { sample: computed, time })
    }

    /// Whether the loop is linear and the same in every tick.
    fn is_linear(&self) -> bool {
        let centred = wall(&self.scene).is_none_or(|wall| !wall.one_sided && wall.face == 0.0);
        let unlimited = self.scene.torque_limit.is_none() && self.encoder_step.is_none();
        centred && unlimited && self.friction == 0.0 && self.missed == Missed::None
    }

    /// The plant over a tick.
    ///
    /// # Errors
    /// Where the machine is too fast for its motion over a period to be computed.
    pub fn tick(&self, stride: Stride) -> Result<Tick, SimulationError> {
        Tick::checked(&self.plant, &self.stepping(stride), self.drive.omega())
    }

    /// How the plant is taken through a tick.
    pub fn stepping(&self, stride: Stride) -> Stepping {
        Stepping {
            method: stride.method,
            substeps: stride.substeps.max(1),
            period: self.scene.timing.period,
            latency: self.latency,
        }
    }
}

/// The wall of a scene, if it has one.
pub(crate) fn wall(scene: &Scene) -> Option<&Wall> {
    match &scene.environment {
        Environment::DelayedSpring(wall)
        | Environment::DamperWall(wall)
        | Environment::FreeModeWall { wall, .. } => Some(wall),
        Environment::FreeMode { .. } | Environment::Rational(_) => None,
    }
}

/// Method and steps a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stride {
    /// The method.
    pub method: Method,
    /// Steps a tick, at least one; the exact method takes the tick in one whatever this is.
    pub substeps: u32,
}

impl Default for Stride {
    fn default() -> Self {
        Self { method: Method::Exact, substeps: 1 }
    }
}

/// Samples at the instants of the ticks, all of them finite: a motion that grows beyond the range
/// of numbers ends before it does ([`Experiment::completed`]).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Trajectory {
    /// Position of the encoder's mass in rad.
    pub position: Vec<f64>,
    /// Its velocity in rad/s.
    pub velocity: Vec<f64>,
    /// Coupling torque `F` in N m; the motor applies `-F`.
    pub torque: Vec<f64>,
    /// Why that torque is not what the scene asked for, where it is not.
    pub limit: Vec<Served>,
}

impl Trajectory {
    /// Room for so many samples.
    pub fn of_length(samples: usize) -> Self {
        let zeros = || vec![0.0; samples];
        let limit = vec![Served::IN_FULL; samples];
        Self { position: zeros(), velocity: zeros(), torque: zeros(), limit }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.position.len()
    }

    fn is_finite(&self, sample: usize) -> bool {
        [&self.position, &self.velocity, &self.torque].iter().all(|of| of[sample].is_finite())
    }

    /// Leaves out what is beyond the range of numbers. The last sample tells whether anything is: a
    /// position that has left the range does not come back.
    fn end_in_range(&mut self) {
        let samples = self.samples();
        if samples == 0 || self.is_finite(samples - 1) {
            return;
        }
        let kept = (0..samples).take_while(|&sample| self.is_finite(sample)).count();
        for column in [&mut self.position, &mut self.velocity, &mut self.torque] {
            column.truncate(kept);
        }
        self.limit.truncate(kept);
    }

    fn columns(&mut self) -> (Columns<'_>, &mut [Served]) {
        let Self { position, velocity, torque, limit } = self;
        (Columns { position, velocity, torque }, limit)
    }
}

/// Where samples are written, one slice each of the same length.
#[derive(Debug)]
pub struct Columns<'t> {
    /// As [`Trajectory::position`].
    pub position: &'t mut [f64],
    /// As [`Trajectory::velocity`].
    pub velocity: &'t mut [f64],
    /// As [`Trajectory::torque`].
    pub torque: &'t mut [f64],
}

/// An experiment in motion.
#[derive(Debug)]
pub struct Simulator {
    drive: Drive,
    engine: Engine,
}

#[derive(Debug)]
enum Engine {
    Linear(Box<dyn Linear>),
    General(Box<General>),
}

impl Simulator {
    /// Sets an experiment up.
    ///
    /// # Errors
    /// Where the scene has no law that could run.
    pub fn new(experiment: &Experiment, stride: Stride) -> Result<Self, SimulationError> {
        let drive = experiment.drive.clone();
        // Refuses what has no law or no motion, whichever way it would be run.
        let general = General::new(experiment, stride)?;
        let tick = experiment.tick(stride)?;
        if experiment.is_linear()
            && let Some(linear) = linear(experiment, &tick)
        {
            return Ok(Self { drive, engine: Engine::Linear(linear) });
        }
        Ok(Self { drive, engine: Engine::General(Box::new(general)) })
    }

    /// The next samples, as many as `trajectory` has room for; it is cut off where the motion
    /// leaves the range of numbers, and nothing comes after that.
    pub fn fill(&mut self, trajectory: &mut Trajectory) {
        let (columns, limit) = trajectory.columns();
        match &mut self.engine {
            Engine::Linear(linear) => {
                // Nothing limits a linear loop.
                limit.fill(Served::IN_FULL);
                linear.fill(&self.drive, columns);
            }
            Engine::General(general) => general.fill(&self.drive, columns, limit),
        }
        trajectory.end_in_range();
    }
}

fn linear(experiment: &Experiment, tick: &Tick) -> Option<Box<dyn Linear>> {
    let closed = ClosedLoop::new(tick, &experiment.scene).ok()?;
    let start = experiment.plant.moving(experiment.start.position, experiment.start.velocity);
    kernel::kernel(&closed, tick, experiment.scene.timing.period, &start)
}

/// Runs an experiment from its start to its end, or as far as there are numbers for it.
///
/// # Errors
/// Where the scene has no law that could run.
pub fn simulate(experiment: &Experiment, stride: Stride) -> Result<Trajectory, SimulationError> {
    let mut trajectory = Trajectory::of_length(experiment.samples);
    Simulator::new(experiment, stride)?.fill(&mut trajectory);
    Ok(trajectory)
}

#[cfg(test)]
mod tests;
