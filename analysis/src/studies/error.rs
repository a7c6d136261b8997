//! The reasons why a study has no figures.

use std::io;

use haptic_servo::certificate::Rejection;
use haptic_servo::environment::ShapeError;
use haptic_servo::number::OutOfRange;
use haptic_servo::servo::BuildError;
use thiserror::Error;

use crate::chain::ChainError;
use crate::emulator::EmulatorError;
use crate::file::FileError;
use crate::link::LinkError;
use crate::simulation::SimulationError;
use crate::toolchain;

/// The reason why a study has no figures, as its sentence says.
#[allow(missing_docs)]
#[derive(Debug, Error)]
pub enum StudyError {
    #[error("{0}")]
    Refused(Box<Rejection>),
    #[error(transparent)]
    Chain(#[from] ChainError),
    #[error(transparent)]
    Shape(#[from] ShapeError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Servo(#[from] BuildError),
    #[error("the device's angle: {0}")]
    Angle(#[from] OutOfRange),
    #[error(transparent)]
    Setup(#[from] toolchain::SetupError),
    #[error(transparent)]
    Build(#[from] toolchain::BuildError),
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("this wall has no largest certified stiffness")]
    NoLimit,
    #[error(
        "{scene}: nothing moves in its simulation, so models cannot be compared; give it a \
         position, a velocity or a torque"
    )]
    Rest { scene: String },
    /// The limit cycle at rest cannot be found, within so many seconds.
    #[error(
        "the motion of this device does not decay by half in {seconds} s, so a limit cycle at rest \
         cannot be distinguished from it: give the device more damping, or the scene more margin"
    )]
    NoRest { seconds: f64 },
    /// Ticks are counted from 0.
    #[error(
        "in {format} the torque of the emulated board differs from that of this machine at tick \
         {tick}: its program has another version"
    )]
    Differs { format: &'static str, tick: usize },
    /// The compiler, the interpreter or the package of a peer is missing.
    #[error("{0}")]
    NoPeer(String),
    #[error("a peer of the benchmark ended: {0}")]
    PeerEnded(#[from] io::Error),
    /// Something else, or other numbers: its work is not equal.
    #[error("a peer of the benchmark answered {0}")]
    WrongPeer(String),
}

impl From<Rejection> for StudyError {
    fn from(rejection: Rejection) -> Self {
        Self::Refused(Box::new(rejection))
    }
}
