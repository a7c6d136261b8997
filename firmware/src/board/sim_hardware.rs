//! The hardware of simulated boards, whose ticks are always in time.

use crate::boot::Startup;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::{Fault, FaultRecord};
use crate::reset::ResetCause;
use crate::servo_loop::Hardware;

/// Inputs and outputs of a simulated board's program.
pub trait SimIo {
    /// The encoder's counter.
    fn count(&mut self) -> RawCount;
    /// Writes a code to the DAC.
    fn write(&mut self, code: DacCode);
    /// Switches the amplifier.
    fn amplifier(&mut self, _on: bool) {}
    /// [`Hardware::periods_since_last`].
    fn periods_since_last(&mut self) -> u32 {
        1
    }
    /// [`Hardware::reading_fault`].
    fn reading_fault(&mut self) -> Option<Fault> {
        None
    }
    /// Ticks after that in which it does not follow the code yet.
    fn start_up_ticks(&self) -> u32 {
        0
    }
}

/// A board after power-on, without a watchdog, whose ticks take no time.
#[derive(Clone, Debug)]
pub struct SimHardware<L> {
    /// Encoder, DAC and amplifier.
    pub lines: L,
    /// Timer counts in a period.
    period: u32,
}

impl<L> SimHardware<L> {
    /// A board with `period` timer counts in a period.
    pub const fn new(lines: L, period: u32) -> Self {
        Self { lines, period }
    }
}

impl<L: SimIo> Hardware for SimHardware<L> {
    fn count(&mut self) -> RawCount {
        self.lines.count()
    }

    fn write(&mut self, code: DacCode) {
        self.lines.write(code);
    }

    fn amplifier(&mut self, on: bool) {
        self.lines.amplifier(on);
    }

    fn start_up_ticks(&self) -> u32 {
        self.lines.start_up_ticks()
    }

    fn periods_since_last(&mut self) -> u32 {
        self.lines.periods_since_last()
    }

    fn reading_fault(&mut self) -> Option<Fault> {
        self.lines.reading_fault()
    }

    fn time_in_period(&mut self) -> u32 {
        0
    }

    fn feed_watchdog(&mut self) {}
}

impl<L: SimIo> Startup for SimHardware<L> {
    fn zero_encoder(&mut self) {}

    fn start_watchdog(&mut self) {}

    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS] {
        FaultRecord::NOTHING
    }

    fn reset_cause(&mut self) -> ResetCause {
        ResetCause::PowerOn
    }

    fn period(&self) -> u32 {
        self.period
    }
}
