//! Cost on a running board of certifying a set of parameters from a host.

use std::path::Path;

use haptic_servo::certificate::Parameter;
use thiserror::Error;

use crate::emulator::plant_thread::{FixedCount, PlantThread};
use crate::emulator::{Emulator, EmulatorError};
use crate::link::{Address, Link, LinkError, RequestResult};

/// The cost of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LiveSet {
    /// Whether it was accepted.
    pub taken: bool,
    /// Instructions below the servo, from the frame's last byte to the answer's first.
    pub instructions: u64,
    /// Largest number of instructions of the servo's interrupt meanwhile, including requests.
    pub interrupt: u64,
    /// Bytes of the stack that were never used, before and after.
    pub stack_left: Option<u32>,
}

/// The reason why a set could not be measured.
#[derive(Debug, Error)]
pub enum LiveError {
    /// The emulated board.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The link to the board.
    #[error(transparent)]
    Link(#[from] LinkError),
}

/// Sends a set to a program on the emulated board, whose servo runs meanwhile.
///
/// # Errors
/// If the board or the link fails.
pub fn live_set(elf: &Path, changes: &[(Parameter, f64)]) -> Result<LiveSet, LiveError> {
    let mut emulator = Emulator::boot(elf)?;
    emulator.arm_and_wait()?;
    let plant = PlantThread::start(emulator, FixedCount(0));
    let mut link = Link::open(&Address::Unix(plant.port().to_owned()))?;
    let outcome = link.set(changes.iter().copied().collect())?;
    let stack_left = link.status()?.stack_left;
    let report = plant.end()?.finish()?;
    Ok(LiveSet {
        taken: outcome == RequestResult::Done,
        instructions: report.below_instructions.max,
        interrupt: report.interrupt_instructions.max,
        stack_left,
    })
}
