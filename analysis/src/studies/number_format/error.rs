//! The reasons why a scene has no figures in a number format.

use haptic_servo::certificate::Rejection;
use haptic_servo::number::OutOfRange;
use haptic_servo::servo::BuildError;
use thiserror::Error;

use crate::emulator::EmulatorError;
use crate::simulation::SimulationError;

/// The reason why a scene has no figures in a number format.
#[derive(Debug, Error)]
pub enum FormatError {
    /// The certificate refuses the scene.
    #[error("{0}")]
    Refused(Box<Rejection>),
    /// The servo cannot be built in this format.
    #[error(transparent)]
    Servo(#[from] BuildError),
    /// An angle does not fit the format.
    #[error("the device's angle: {0}")]
    Angle(#[from] OutOfRange),
    /// The scene cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The limit cycle at rest cannot be found.
    #[error(
        "the motion of this device does not decay by half in {seconds} s, so a limit cycle at rest \
         cannot be distinguished from it: give the device more damping, or the scene more margin"
    )]
    NoRest {
        /// The longest time of the search in s.
        seconds: f64,
    },
    /// The emulated board failed.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The emulated board's result differs.
    #[error(
        "in {format} the torque of the emulated board differs from that of this machine at tick \
         {tick}: its program has another version"
    )]
    Differs {
        /// The number format.
        format: &'static str,
        /// The tick, counted from 0.
        tick: usize,
    },
}
