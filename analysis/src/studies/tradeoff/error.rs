//! The reasons why methods could not be measured.

use thiserror::Error;

use crate::emulator::EmulatorError;
use crate::studies::number_format::FormatError;
use crate::toolchain::{BuildError, SetupError};

/// The reason why methods could not be measured on the emulated board.
#[derive(Debug, Error)]
pub enum TradeoffError {
    /// A number format has no figures.
    #[error(transparent)]
    Arithmetic(#[from] FormatError),
    /// The machine cannot build or run programs for the board.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The board's program does not build.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The emulated board failed.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
}
