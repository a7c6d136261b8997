//! The DAC that drives the amplifier.

use embassy_stm32::pac;

use super::wiring::TIMER_TRIGGER;
use crate::dac::DacCode;

/// A channel of a converter, written to by one register access.
#[derive(Clone, Copy)]
pub struct Converter {
    /// The converter.
    pub registers: pac::dac::Dac,
    /// Its channel, 0 or 1.
    pub channel: usize,
}

impl Converter {
    /// Writes a code. It appears at the pacing timer's next update where the converter is latched,
    /// and at once where it is not.
    #[inline(always)]
    pub fn write(self, code: DacCode) {
        self.registers.dhr12r(self.channel).write(|w| w.set_dhr(code.get()));
    }

    /// From now on each update of the pacing timer passes on what was written last: a code written
    /// anywhere within a period appears exactly at its end.
    pub fn latch(self) {
        self.registers.cr().modify(|w| {
            w.set_tsel(self.channel, TIMER_TRIGGER);
            w.set_ten(self.channel, true);
        });
    }

    /// The code that the converter puts out now.
    pub fn output(self) -> u16 {
        self.registers.dor(self.channel).read().dor()
    }

    /// Gives no torque at once, whatever the timer does.
    pub fn stop(self) {
        self.registers.cr().modify(|w| w.set_ten(self.channel, false));
        self.write(DacCode::MID_SCALE);
    }
}
