//! Simulated boards: their program is always in time.

use crate::boot::Startup;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::FaultRecord;
use crate::reset::ResetCause;
use crate::servo_loop::Hardware;

/// Inputs of a simulated board's program.
pub trait SimIo {
    /// The encoder's counter.
    fn count(&mut self) -> RawCount;
    /// The DAC is given a code.
    fn write(&mut self, code: DacCode);
    /// The amplifier is switched.
    fn amplifier(&mut self, _on: bool) {}
}

/// A board whose ticks take no time, which is fresh from power-on and needs no watchdog.
#[derive(Clone, Debug)]
pub struct SimHardware<L> {
    /// Encoder, DAC and amplifier.
    pub lines: L,
    /// Timer counts in a period.
    period: u32,
}

impl<L> SimHardware<L> {
    /// A board with so many timer counts in a period.
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

    fn periods_since_last(&mut self) -> u32 {
        1
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
