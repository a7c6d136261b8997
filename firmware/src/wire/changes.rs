//! Numbers of a scene that are sent or requested together.

use heapless::Vec;

use crate::certificate::Parameter;
use crate::tuning::TUNABLE;

/// The largest number of changes in a set: as many as there are tunable parameters.
pub const MAX_CHANGES: usize = TUNABLE.len();

/// Numbers of a scene with their present or requested values, in the units of a scene file. They are applied
/// together or not at all.
pub type Changes = Vec<(Parameter, f64), MAX_CHANGES>;
