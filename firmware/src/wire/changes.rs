//! Numbers of a scene that are sent or requested together.

use heapless::Vec;

use crate::certificate::Parameter;

/// Numbers that one set may change: more than any scene has.
pub const MAX_CHANGES: usize = 8;

/// Numbers of a scene with their values, present or requested, all together or not at all, in the units of a
/// scene file.
pub type Changes = Vec<(Parameter, f64), MAX_CHANGES>;
