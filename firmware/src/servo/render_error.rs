//! What can go wrong between a scene and its rendering.

use core::fmt;

use crate::build_error::BuildError;
use crate::certificate::{Rejection, TimingError};
use crate::tuning::TuningError;

/// Why a scene cannot be rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RenderError {
    /// The change is not one of this scene.
    Tuning(TuningError),
    /// No certificate.
    Rejected(Rejection),
    /// Not with this board's timing.
    Timing(TimingError),
    /// Not with these transducers in this number format.
    Build(BuildError),
}

/// The step from a scene to its servo that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Step {
    /// To change the numbers.
    Change,
    /// The certificate, with what a board does to a torque: its delay and its limits.
    Certificate,
    /// The servo in its number format, with its transducers.
    Servo,
}

impl Step {
    /// As a word.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Change => "change",
            Self::Certificate => "certificate",
            Self::Servo => "servo",
        }
    }
}

impl RenderError {
    /// Where it happened.
    pub const fn step(&self) -> Step {
        match self {
            Self::Tuning(_) => Step::Change,
            Self::Rejected(_) | Self::Timing(_) => Step::Certificate,
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
