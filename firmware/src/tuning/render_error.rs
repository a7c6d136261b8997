//! Reasons why a changed scene cannot be rendered.

use core::fmt;

use super::TuningError;
use crate::build_error::BuildError;
use crate::certificate::{Rejection, TimingError};
use crate::step::Step;

/// The reason why a scene cannot be rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a rejection has its remedies, and nothing is allocated"
)]
pub enum RenderError {
    /// The change does not apply to this scene.
    Tuning(TuningError),
    /// The scene has no certificate.
    Rejected(Rejection),
    /// The scene does not fit this board's timing.
    Timing(TimingError),
    /// The servo cannot be built with these transducers in this number format.
    Build(BuildError),
    /// The change selects another mode, whose table only the board has.
    OtherMode {
        /// Its number.
        mode: f64,
    },
}

impl RenderError {
    /// The step that failed.
    pub const fn step(&self) -> Step {
        match self {
            Self::Tuning(_) => Step::Change,
            Self::Rejected(_) | Self::Timing(_) | Self::OtherMode { .. } => Step::Certificate,
            Self::Build(_) => Step::Servo,
        }
    }
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tuning(error) => error.fmt(f),
            Self::Rejected(rejection) => rejection.fmt(f),
            Self::Timing(error) => error.fmt(f),
            Self::Build(error) => error.fmt(f),
            Self::OtherMode { mode } => write!(
                f,
                "mode {mode} is not certified with the other numbers that run, or that were to change with \
                 it; the board alone has its table, so that the reason is not known here. Every mode is \
                 certified with the numbers that the program was compiled with: set these, select the mode, \
                 and then change them again"
            ),
        }
    }
}

impl core::error::Error for RenderError {}

impl From<TuningError> for RenderError {
    fn from(error: TuningError) -> Self {
        Self::Tuning(error)
    }
}

impl From<Rejection> for RenderError {
    fn from(rejection: Rejection) -> Self {
        Self::Rejected(rejection)
    }
}

impl From<TimingError> for RenderError {
    fn from(error: TimingError) -> Self {
        Self::Timing(error)
    }
}

impl From<BuildError> for RenderError {
    fn from(error: BuildError) -> Self {
        Self::Build(error)
    }
}
