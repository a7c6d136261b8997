//! Reasons why a change does not apply to a scene, and why a changed scene cannot be rendered.

use core::fmt;

use super::{Parameters, TUNABLE, name};
use crate::build_error::BuildError;
use crate::certificate::{Parameter, Rejection, TimingError};
use crate::host::HostError;
use crate::step::Step;

/// Why a change is impossible with any value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum TuningError {
    /// A running program cannot change the parameter.
    Fixed { parameter: Parameter },
    /// The running scene has no such parameter; the parameters that it has.
    Absent { parameter: Parameter, has: Parameters },
    /// The parameter was given two values.
    Twice { parameter: Parameter },
}

impl fmt::Display for TuningError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |parameter: &Parameter| name(*parameter).unwrap_or(parameter.name_and_unit().0);
        match self {
            Self::Fixed { parameter } => {
                let (fixed, tunable) =
                    (name(parameter), TUNABLE.iter().map(|(_, tunable)| *tunable));
                let all = Parameters::of(tunable);
                write!(
                    f,
                    "the {fixed} is fixed while the program runs; the tunable parameters are {all}"
                )
            }
            Self::Absent { parameter, has } => {
                write!(f, "this scene has no {}; it has {has}", name(parameter))
            }
            Self::Twice { parameter } => write!(f, "{} is given twice", name(parameter)),
        }
    }
}

impl core::error::Error for TuningError {}

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
    /// There is no proof for the program's host beside the scene.
    Host(HostError),
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
            Self::Build(_) | Self::Host(_) => Step::Servo,
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
            Self::Host(error) => error.fmt(f),
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

/// The conversions of its causes.
macro_rules! causes {
    ($($variant:ident($cause:ty))+) => {$(
        impl From<$cause> for RenderError {
            fn from(cause: $cause) -> Self {
                Self::$variant(cause)
            }
        }
    )+};
}
causes! { Tuning(TuningError) Rejected(Rejection) Timing(TimingError) Build(BuildError) Host(HostError) }
