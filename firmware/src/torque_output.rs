//! Converts codes to torque: a DAC with an amplifier, or the bridge of a motor board.
//!
//! The servo uses both through the same calls. They differ in the latency of a torque, which the scene states
//! ([`Latency`](crate::scene::Latency)) and the compiler compares with the output's own.

use crate::current::{AlignmentError, HeatStep, PowerFault};
use crate::dac::DacCode;
use crate::fault::Fault;

/// An event of a torque output for the servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputEvent {
    /// A fault: the output has already removed the torque.
    Fault(Fault),
    /// The torque's limit moves by a step, because of the heat of the current.
    Heat(HeatStep),
}

/// A torque output; each method is one or two accesses to registers or memory.
pub trait TorqueOutput {
    /// Sets the code of the next torque, which is due at the time of the program's
    /// [`OutputMode`](crate::servo::OutputMode).
    fn set(&mut self, code: DacCode);

    /// Switches the motor on or off. Off removes the torque at once; on may take until the next code, and may
    /// fail with a [fault](Self::event).
    fn switch(&mut self, on: bool);

    /// Periods after switching on for which the code must be that of zero torque, because the output is not ready
    /// to follow another.
    fn start_up_ticks(&self) -> u32 {
        0
    }

    /// Begins to align a brushless motor whose gates are off.
    ///
    /// # Errors
    /// If this output does not have a brushless motor.
    fn align(&mut self) -> Result<(), Fault> {
        Err(Fault::Power(PowerFault::Alignment(AlignmentError::NotNeeded)))
    }

    /// Whether an alignment runs.
    fn is_aligning(&self) -> bool {
        false
    }

    /// An event of the output since the last call.
    fn event(&mut self) -> Option<OutputEvent>;
}
