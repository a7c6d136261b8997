//! Hardware of the servo's interrupt.

use crate::current::{AlignmentError, PowerFault};
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::{Fault, FaultRecord};
#[cfg(doc)]
use crate::output_timing::READ_WITHIN;

/// What [`Hardware::periods_since_last`] gives for one period whose tick began later than [`READ_WITHIN`].
pub const BEGAN_LATE: u32 = 0;

/// The board in the servo's interrupt: each method is an access or two to a register.
pub trait Hardware {
    /// The encoder's counter.
    fn count(&mut self) -> RawCount;
    /// Gives a code to the DAC, or to the board's own current loop; when it reaches the motor is the mode's matter.
    fn write(&mut self, code: DacCode);
    /// Switches the motor's amplifier, or the board's bridge.
    fn amplifier(&mut self, on: bool);
    /// A fault of the torque's source, since this was last called; the torque is already gone. A DAC has
    /// none.
    fn output_fault(&mut self) -> Option<Fault> {
        None
    }
    /// Begins to align a brushless motor, which moves the handle.
    ///
    /// # Errors
    /// If the board has no brushless motor on its bridge.
    fn align(&mut self) -> Result<(), Fault> {
        Err(Fault::Power(PowerFault::Alignment(AlignmentError::NotNeeded)))
    }
    /// Whether an alignment runs.
    fn is_aligning(&mut self) -> bool {
        false
    }
    /// Whole periods that began since the last call: 1 in time, more where ticks were missed, and
    /// [`BEGAN_LATE`] for one whose tick is late. A simulated board whose count is the one at its
    /// period's beginning however late the tick is has no such thing.
    fn periods_since_last(&mut self) -> u32;
    /// Timer counts since the period of this tick began; at least a period once the next one has
    /// begun.
    fn time_in_period(&mut self) -> u32;
    /// Feeds the watchdog.
    fn feed_watchdog(&mut self);
    /// Keeps a [`FaultRecord`] record in memory that outlives a reset, or clears it. Rare.
    fn store_fault(&mut self, _record: &[u32; FaultRecord::WORDS]) {}
}
