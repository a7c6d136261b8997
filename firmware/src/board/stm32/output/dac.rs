//! The DAC that drives the amplifier.

use embassy_stm32::Peri;
use embassy_stm32::dac::{Channel, DacPin};
use embassy_stm32::gpio::Flex;
use embassy_stm32::pac;
use embassy_stm32::peripherals::DAC1;
use embassy_stm32::rcc;

use crate::board::stm32::wiring::{DAC_RANGE, TIMER_TRIGGER};
use crate::dac::DacCode;
use crate::output_timing::OutputTiming;

// What the servo computes for is what this board's output is linear over.
const _: () = assert!(
    DAC_RANGE.codes_each_way() >= DacCode::CODES_TO_FULL_SCALE,
    "this board's DAC saturates within the codes of full scale"
);

/// TIM7's update among the triggers of the DAC, TSEL of DAC_CR, in both families (RM0440 and RM0090, tables
/// of the DAC's triggers; `DAC_TRIGGER_T7_TRGO` in ST's drivers).
const PHASE_TRIGGER: u8 = 2;

/// A channel of the DAC, written to by one register access.
#[derive(Clone, Copy)]
pub struct DacChannel {
    /// The DAC.
    pub registers: pac::dac::Dac,
    /// Its channel, 0 or 1.
    pub channel: usize,
}

impl DacChannel {
    /// Clocks the DAC and lets it drive its pin, at mid-scale from the first moment on: the
    /// chips' reset value would be full torque the negative way.
    pub fn connect<C: Channel>(
        self,
        _: Peri<'static, DAC1>,
        pin: Peri<'static, impl DacPin<DAC1, C>>,
    ) {
        rcc::enable_and_reset::<DAC1>();
        // The interface's range of bus clocks, above 160 MHz (RM0440, 22.7.16).
        #[cfg(any(feature = "nucleo-g474re", feature = "b-g431b-esc1"))]
        self.registers.mcr().modify(|w| w.set_hfsel(0b10));
        self.write(DacCode::MID_SCALE);
        self.registers.cr().modify(|w| w.set_en(self.channel, true));
        let mut pin = Flex::new(pin);
        pin.set_as_analog();
        // A driver that is dropped disconnects its pin.
        core::mem::forget(pin);
    }

    /// Writes a code. It appears at the timer's next trigger where the DAC [has one](Self::latch), and
    /// at once where it has none.
    #[inline(always)]
    pub fn write(self, code: DacCode) {
        self.registers.dhr12r(self.channel).write(|w| w.set_dhr(code.get()));
    }

    /// From now on a timer outputs the last written code: where torques are latched, each update of the
    /// pacing timer, so that a code written anywhere within a period appears exactly at its end, and
    /// where they have a phase, each update of the timer behind it. TSEL and TEN of DAC_CR; the code in
    /// DAC_DOR follows a trigger by a few clocks of the bus.
    pub fn latch(self, timing: OutputTiming) {
        let trigger = match timing {
            OutputTiming::Simultaneous => return,
            OutputTiming::Latched => TIMER_TRIGGER,
            OutputTiming::AtPhase(_) => PHASE_TRIGGER,
        };
        self.registers.cr().modify(|w| {
            w.set_tsel(self.channel, trigger);
            w.set_ten(self.channel, true);
        });
    }

    /// The code that the DAC puts out now.
    pub fn output(self) -> u16 {
        self.registers.dor(self.channel).read().dor()
    }

    /// Zero torque at once, without the timer. Mid-scale is written over the code that waits for the trigger
    /// before the trigger is taken away: without a trigger, the last code written is put out.
    pub fn stop(self) {
        self.write(DacCode::MID_SCALE);
        self.registers.cr().modify(|w| w.set_ten(self.channel, false));
        self.write(DacCode::MID_SCALE);
    }
}
