//! What makes torque of a code: a DAC in front of an amplifier, or the bridge of a motor board.
//!
//! The servo drives either through the same four calls and does not know which one it is; what differs is
//! the time that a torque takes, which the scene states ([`Latency`](crate::scene::Latency)), and which the
//! compiler compares with the output's own.

use crate::current::{AlignmentError, PowerFault};
use crate::dac::DacCode;
use crate::fault::Fault;

/// What turns codes into torque; each method is an access or two to a register or to memory.
pub trait TorqueOutput {
    /// Gives the code whose torque is due next: at the instant that the program's
    /// [`OutputMode`](crate::servo::OutputMode) says.
    fn set(&mut self, code: DacCode);

    /// Switches the motor on or off. Off takes the torque away at once; on may take until the next code, and
    /// fails by a [fault](Self::fault).
    fn switch(&mut self, on: bool);

    /// Begins to align a brushless motor, with the gates off until now.
    ///
    /// # Errors
    /// Where this output has no motor that is to be aligned.
    fn align(&mut self) -> Result<(), Fault> {
        Err(Fault::Power(PowerFault::Alignment(AlignmentError::NotNeeded)))
    }

    /// Whether an alignment runs.
    fn is_aligning(&self) -> bool {
        false
    }

    /// A fault of its own since this was last asked. The output has taken the torque away by itself.
    fn fault(&mut self) -> Option<Fault>;
}
