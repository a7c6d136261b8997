//! Reasons why a change does not apply to a scene.

use core::fmt;

use super::{Parameters, TUNABLE, name};
use crate::certificate::Parameter;

/// Why a change is impossible with any value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TuningError {
    /// A running program cannot change the parameter.
    Fixed {
        /// Which.
        parameter: Parameter,
    },
    /// The running scene has no such parameter.
    Absent {
        /// Which.
        parameter: Parameter,
        /// The parameters of the scene.
        has: Parameters,
    },
    /// The parameter was given two values.
    Twice {
        /// Which.
        parameter: Parameter,
    },
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
