//! Numbers of a scene that are sent or requested together.

use heapless::Vec;

use crate::certificate::Parameter;
use crate::parameter::TUNABLE;

/// The host's number for a request; the answer has the same number.
pub type Id = u16;

/// The largest number of changes in a set.
pub const MAX_CHANGES: usize = 8;

/// Numbers of a scene with their present or requested values, in the units of a scene file. They are applied
/// together or not at all.
pub type Changes = Vec<(Parameter, f64), MAX_CHANGES>;

/// All numbers of a scene that can be changed, with their values.
pub type Values = Vec<(Parameter, f64), { TUNABLE.len() }>;
