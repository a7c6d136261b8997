//! Hardware of the servo's interrupt.

use crate::current::{AlignmentError, PowerFault};
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::{Fault, FaultRecord};
#[cfg(doc)]
use crate::output_timing::READ_WITHIN;
use crate::torque_output::OutputEvent;

/// The result of [`Hardware::periods_since_last`] for one period whose tick began later than [`READ_WITHIN`].
pub const BEGAN_LATE: u32 = 0;

/// The board in the servo's interrupt: each method is an access or two to a register.
pub trait Hardware {
    /// The encoder's counter.
    fn count(&mut self) -> RawCount;
    /// Writes a code to the DAC, or to the board's own current loop; the output mode decides when it reaches
    /// the motor.
    fn write(&mut self, code: DacCode);
    /// Switches the motor's amplifier, or the board's bridge.
    fn amplifier(&mut self, on: bool);
    /// An event of the torque output since the last call. A DAC has none.
    fn output_event(&mut self) -> Option<OutputEvent> {
        None
    }
    /// Ticks after switching the amplifier on in which it does not follow the code yet; the servo's torque is zero
    /// for so long.
    fn start_up_ticks(&self) -> u32 {
        0
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
    /// Whole periods that began since the last call: 1 in time, more after missed ticks, and [`BEGAN_LATE`]
    /// for one period whose tick is late. A simulated board may omit [`BEGAN_LATE`] if its count is always
    /// that of the period's beginning.
    fn periods_since_last(&mut self) -> u32;
    /// Timer counts since the period of this tick began; at least a period once the next one has
    /// begun.
    fn time_in_period(&mut self) -> u32;
    /// Feeds the watchdog.
    fn feed_watchdog(&mut self);
    /// Keeps a [`FaultRecord`] in memory that survives a reset, or clears it. Rare.
    fn store_fault(&mut self, _record: &[u32; FaultRecord::WORDS]) {}
}
