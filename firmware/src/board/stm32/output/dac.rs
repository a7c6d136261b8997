//! The DAC for an external amplifier.

use embassy_stm32::Peri;
use embassy_stm32::dac::{Channel, DacPin};
use embassy_stm32::gpio::Flex;
use embassy_stm32::pac;
use embassy_stm32::peripherals::DAC1;
use embassy_stm32::rcc;

use crate::board::stm32::wiring::{DAC_RANGE, TIMER_TRIGGER};
use crate::dac::DacCode;
use crate::output_timing::OutputTiming;

// The servo's range of codes is the linear range of this board's output.
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
    /// Enables the DAC and its pin, at mid-scale from the first moment on: the chips' reset value would be
    /// full negative torque.
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
        // A dropped driver disconnects its pin.
        core::mem::forget(pin);
    }

    /// Writes a code. It appears at the next trigger if the DAC has [a trigger](Self::latch), and otherwise
    /// at once.
    #[inline(always)]
    pub fn write(self, code: DacCode) {
        self.registers.dhr12r(self.channel).write(|w| w.set_dhr(code.get()));
    }

    /// From now on a timer puts out the last written code. Latched torques come at each update of the pacing
    /// timer, so that a code written anywhere within a period appears exactly at its end; torques with a
    /// phase come at each update of the second timer. TSEL and TEN of DAC_CR; the code in DAC_DOR follows a
    /// trigger by a few clocks of the bus.
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

    /// Zero torque at once, without the timer. Mid-scale overwrites the waiting code before the trigger is
    /// disabled: without a trigger, the DAC puts out the last written code.
    pub fn stop(self) {
        self.write(DacCode::MID_SCALE);
        self.registers.cr().modify(|w| w.set_ten(self.channel, false));
        self.write(DacCode::MID_SCALE);
    }
}
