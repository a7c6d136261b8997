//! Why there is no motion.

use haptic_servo::host::HostError;
use haptic_servo::passivity::transfer::Unbuildable;
use haptic_servo::servo::BuildError;
use thiserror::Error;

use crate::quantity::significant;

/// Why there is no answer.
#[derive(Debug, Error)]
pub enum SimulationError {
    /// The file has no `[simulation]`.
    #[error("{scene}: a simulation needs a [simulation] table with `samples`")]
    NoSimulation {
        /// Name of the scene.
        scene: String,
    },
    /// The scene has no law that could run.
    #[error("the scene cannot run: {0}")]
    Servo(#[from] BuildError),
    /// The scene cannot have this host.
    #[error("{0}")]
    Host(#[from] HostError),
    /// The scene has no linear loop.
    #[error("the scene has no closed loop: {}", unbuildable(*.0))]
    LoopTransfers(Unbuildable),
    /// The torque file cannot be read, is not text, or has something in it that is not a finite number.
    #[error("{0}")]
    TorqueFile(String),
    /// A torque begins between two updates of the amplifier.
    #[error(
        "a torque begins {delay} s after its count or a later one, between two updates of the amplifier, which \
         are {between} s apart"
    )]
    BetweenUpdates {
        /// Time in s into the tick.
        delay: f64,
        /// Time in s between two updates.
        between: f64,
    },
    /// The motion over a period is out of range.
    #[error(
        "overflow: the motion over a period of {period:e} s, with rates of up to {rate:.1e} per \
         second, exceeds the range of numbers; check the period, and inertia, damping and \
         stiffness of device and hand"
    )]
    TooFast {
        /// Largest of the machine's rates in 1/s, or of their squares in 1/s^2.
        rate: f64,
        /// The period in s.
        period: f64,
    },
    /// The motion grows beyond the range of numbers.
    #[error(
        "overflow: the motion exceeds the range of numbers from sample {sample} on, at {} s; the \
         loop is unstable (`haptic stability`)", significant(*.time, 6)
    )]
    Overflow {
        /// The first sample, counted from 0, with a number that is not finite.
        sample: usize,
        /// Its time in s.
        time: f64,
    },
    /// More readings in a row have failed than the scene allows.
    #[error(
        "the fault encoder-reading: at sample {sample}, at {} s, more readings of the encoder in a row have failed \
         than `encoder.dropped` = {allowed}, and the amplifier is off from there on", significant(*.time, 6)
    )]
    Readings {
        /// The sample, counted from 0.
        sample: usize,
        /// Its time in s.
        time: f64,
        /// Readings in a row that may fail.
        allowed: u16,
    },
    /// No eigenvalues were found.
    #[error(
        "the eigenvalues of the closed loop did not converge: its numbers differ too much in \
             magnitude"
    )]
    Eigenvalues,
}

impl From<Unbuildable> for SimulationError {
    fn from(error: Unbuildable) -> Self {
        Self::LoopTransfers(error)
    }
}

/// The reason why a scene has no linear loop.
pub fn unbuildable(error: Unbuildable) -> &'static str {
    match error {
        Unbuildable::Improper => "its environment needs future samples",
        Unbuildable::IllPosed => "coupling and environment have no unique solution",
        Unbuildable::OutOfRange => "one of its numbers is out of range",
        Unbuildable::Unstated => {
            "its environment is a torque profile, or stated by a bound alone, and has no transfer function"
        }
    }
}
