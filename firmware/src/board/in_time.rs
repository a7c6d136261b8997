//! Boards that are simulated: whatever their program does, it is in time.

use crate::boot::Startup;
use crate::cycle::Hardware;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::Retained;
use crate::reset::ResetCause;

/// What a simulated board's program sees of its device.
pub trait Lines {
    /// The encoder's counter.
    fn count(&mut self) -> RawCount;
    /// The converter is given a code.
    fn write(&mut self, code: DacCode);
    /// The amplifier is switched.
    fn amplifier(&mut self, _on: bool) {}
}

/// A board whose ticks take no time, which is fresh from power-on and needs no watchdog.
#[derive(Clone, Debug)]
pub struct InTime<L> {
    /// Encoder, converter and amplifier.
    pub lines: L,
    /// Timer counts in a period.
    period: u32,
}

impl<L> InTime<L> {
    /// A board with so many timer counts in a period.
    pub const fn new(lines: L, period: u32) -> Self {
        Self { lines, period }
    }
}

impl<L: Lines> Hardware for InTime<L> {
    fn count(&mut self) -> RawCount {
        self.lines.count()
    }

    fn write(&mut self, code: DacCode) {
        self.lines.write(code);
    }

    fn amplifier(&mut self, on: bool) {
        self.lines.amplifier(on);
    }

    fn passed(&mut self) -> u32 {
        1
    }

    fn elapsed(&mut self) -> u32 {
        0
    }

    fn feed(&mut self) {}
}

impl<L: Lines> Startup for InTime<L> {
    fn zero(&mut self) {}

    fn guard(&mut self) {}

    fn kept(&mut self) -> [u32; Retained::WORDS] {
        Retained::NOTHING
    }

    fn reset_cause(&mut self) -> ResetCause {
        ResetCause::PowerOn
    }

    fn period(&self) -> u32 {
        self.period
    }
}
