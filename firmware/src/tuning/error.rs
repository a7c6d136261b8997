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
        match self {
            Self::Fixed { parameter } => {
                let (fixed, _) = parameter.name_and_unit();
                write!(
                    f,
                    "the {fixed} is fixed while the program runs; the tunable parameters are \
                           "
                )?;
                for (i, (name, _)) in TUNABLE.iter().enumerate() {
                    write!(f, "{}{name}", if i > 0 { ", " } else { "" })?;
                }
                Ok(())
            }
            Self::Absent { parameter, has } => {
                let absent = name(*parameter).unwrap_or(parameter.name_and_unit().0);
                write!(f, "this scene has no {absent}; it has {has}")
            }
            Self::Twice { parameter } => {
                let twice = name(*parameter).unwrap_or(parameter.name_and_unit().0);
                write!(f, "{twice} is given twice")
            }
        }
    }
}

impl core::error::Error for TuningError {}
