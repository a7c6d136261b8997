//! The DAC, and the pin that enables an external amplifier.

use embassy_stm32::Peri;
use embassy_stm32::dac::{Channel, DacPin};
use embassy_stm32::gpio::Flex;
use embassy_stm32::pac;
use embassy_stm32::peripherals::DAC1;
use embassy_stm32::rcc;

use super::pace::Pace;
use super::tick_timer;
use crate::board::stm32::family::TIMER_TRIGGER;
use crate::board::stm32::wiring::AMPLIFIER;
use crate::build_error::BuildError;
use crate::current::TorqueSource;
use crate::dac::{DacCode, OutputRange};
use crate::output_timing::OutputTiming;
use crate::power_reading::PowerReading;

/// The DAC and its channel, from 0, on every board; the pin is PA4.
const DAC: pac::dac::Dac = pac::DAC1;
const CHANNEL: usize = 0;

/// The range of the output buffer: 0.2 V from either rail (DS12288, DS12589, DS8626). The reference is the boards'
/// analogue supply of 3.3 V, at its lowest three per cent below nominal (of the Feather an AP2112, whose tolerance
/// is not read in its data sheet).
const RANGE: OutputRange = OutputRange { supply: 3.2, headroom: 0.2 };

// The servo's range of codes is the linear range of the boards' outputs.
const _: () = assert!(
    RANGE.codes_each_way() >= DacCode::CODES_TO_FULL_SCALE,
    "the DAC saturates within the codes of full scale"
);

/// TIM7's update among the triggers of the DAC, TSEL of DAC_CR, in both families (RM0440 and RM0090, tables
/// of the DAC's triggers; `DAC_TRIGGER_T7_TRGO` in ST's drivers).
const PHASE_TRIGGER: u8 = 2;

/// Enables the DAC and its pin, at mid-scale from the first moment on: the chips' reset value would be
/// full negative torque.
pub fn connect<C: Channel>(_: Peri<'static, DAC1>, pin: Peri<'static, impl DacPin<DAC1, C>>) {
    rcc::enable_and_reset::<DAC1>();
    // The interface's range of bus clocks, above 160 MHz (RM0440, 22.7.16).
    #[cfg(any(feature = "nucleo-g474re", feature = "b-g431b-esc1"))]
    DAC.mcr().modify(|w| w.set_hfsel(0b10));
    write(DacCode::MID_SCALE);
    DAC.cr().modify(|w| w.set_en(CHANNEL, true));
    let mut pin = Flex::new(pin);
    pin.set_as_analog();
    // A dropped driver disconnects its pin.
    core::mem::forget(pin);
}

/// Writes a code. It appears at the next trigger if the DAC has [a trigger](latch), and otherwise at once.
#[inline(always)]
fn write(code: DacCode) {
    DAC.dhr12r(CHANNEL).write(|w| w.set_dhr(code.get()));
}

/// From now on a timer puts out the last written code. Latched torques come at each update of the pacing
/// timer, so that a code written anywhere within a period appears exactly at its end; torques with a
/// phase come at each update of the second timer. TSEL and TEN of DAC_CR; the code in DAC_DOR follows a
/// trigger by a few clocks of the bus.
fn latch(timing: OutputTiming) {
    let trigger = match timing {
        OutputTiming::Simultaneous => return,
        OutputTiming::Latched => TIMER_TRIGGER,
        OutputTiming::AtPhase(_) => PHASE_TRIGGER,
    };
    DAC.cr().modify(|w| {
        w.set_tsel(CHANNEL, trigger);
        w.set_ten(CHANNEL, true);
    });
}

/// The code that the DAC puts out now.
pub fn present_code() -> u16 {
    DAC.dor(CHANNEL).read().dor()
}

/// Zero torque at once, without the timer. Mid-scale overwrites the waiting code before the trigger is
/// disabled: without a trigger, the DAC puts out the last written code.
pub fn stop() {
    write(DacCode::MID_SCALE);
    DAC.cr().modify(|w| w.set_ten(CHANNEL, false));
    write(DacCode::MID_SCALE);
}

/// The properties of a program that this output needs: none.
#[derive(Clone, Copy, Debug)]
pub struct Setup;

impl Setup {
    /// A program for the DAC.
    pub const DAC: Self = Self;

    /// `None`: the response of an external amplifier is unknown.
    pub const fn torque_source(&self) -> Option<TorqueSource> {
        None
    }
}

/// The output.
#[derive(Debug)]
pub struct Output(());

impl Output {
    /// The output and the servo's timer; neither runs yet.
    ///
    /// # Errors
    /// If the board cannot pace the period in s: see [`period`](crate::period::check).
    pub fn new(_: Setup, period: f64, timing: OutputTiming) -> Result<(Self, Pace), BuildError> {
        Ok((Self(()), tick_timer::prepare(period, timing)?))
    }

    /// Starts the timers: one latches the DAC, which holds mid-scale, and one paces the servo.
    pub fn start(&mut self, pace: &mut Pace, timing: OutputTiming) {
        latch(timing);
        tick_timer::start(pace, timing);
    }

    /// Sets the code of the next torque.
    #[inline(always)]
    pub fn set(&mut self, code: DacCode) {
        write(code);
    }

    /// Switches the amplifier.
    #[inline(always)]
    pub fn switch(&mut self, on: bool) {
        AMPLIFIER.set(on);
    }
}

/// Disables the amplifier with one write, in any state of the program.
pub fn off() {
    AMPLIFIER.set(false);
}

/// An external amplifier reports no measurements.
pub fn power_reading() -> Option<PowerReading> {
    None
}

/// The set-up of the DAC for a program; a program for the bridge is refused.
#[doc(hidden)]
#[macro_export]
macro_rules! board_output {
    ([]) => {
        /// The output's data of this program.
        const OUTPUT: $crate::board::stm32::output::Setup =
            $crate::board::stm32::output::Setup::DAC;
    };
    ([$current_loop:ident]) => {
        /// The output's data of this program.
        const OUTPUT: $crate::board::stm32::output::Setup =
            $crate::board::stm32::output::Setup::DAC;
        compile_error!(
            "the latency of this scene is that of a board's own bridge, and its program drives the DAC: \
             build it for a board with a bridge (--board b-g431b-esc1 --output bridge)"
        );
    };
}

/// The set-up of the DAC for a sweep.
#[doc(hidden)]
#[macro_export]
macro_rules! sweep_output {
    ($bridge:tt) => {
        $crate::board_output!([]);
    };
}
