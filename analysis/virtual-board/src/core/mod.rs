//! The parts of a Cortex-M4 other than its instructions: exceptions and the system registers (ARM DDI 0403E).

pub mod exceptions;
pub mod system;

pub use exceptions::Exceptions;
pub use system::System;
