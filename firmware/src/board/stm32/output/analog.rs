//! The DAC, and the pin that enables an external amplifier.

use super::Pace;
use crate::board::stm32::start::halt_with;
use crate::board::stm32::wiring::{AMPLIFIER, DAC};
use crate::build_error::BuildError;
use crate::current::TorqueSource;
use crate::dac::DacCode;
use crate::output_timing::OutputTiming;
use crate::power_reading::PowerReading;
use crate::torque_output::{OutputEvent, TorqueOutput};

/// The properties of a program that this output needs: whether the program is for this output.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    is_served: bool,
}

impl Setup {
    /// A program for the DAC.
    pub const DAC: Self = Self { is_served: true };
    /// A program whose scene has the latency of a bridge. It does not run: cargo builds all programs beside
    /// the tests on a board, and none of them is flashed.
    pub const BRIDGE: Self = Self { is_served: false };

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
    pub fn new(
        setup: Setup,
        period: f64,
        timing: OutputTiming,
    ) -> Result<(Self, Pace), BuildError> {
        if !setup.is_served {
            halt_with("its latency, which is that of a bridge");
        }
        Ok((Self(()), Pace::prepare(period, timing)?))
    }

    /// Starts the timers: one latches the DAC, which holds mid-scale, and one paces the servo.
    pub fn start(&mut self, pace: &mut Pace, timing: OutputTiming) {
        DAC.latch(timing);
        pace.start();
    }
}

impl TorqueOutput for Output {
    #[inline(always)]
    fn set(&mut self, code: DacCode) {
        DAC.write(code);
    }

    #[inline(always)]
    fn switch(&mut self, on: bool) {
        AMPLIFIER.set(on);
    }

    /// An external amplifier reports nothing.
    #[inline(always)]
    fn event(&mut self) -> Option<OutputEvent> {
        None
    }
}

/// Disables the amplifier with one write, in any state of the program.
pub fn off() {
    AMPLIFIER.set(false);
}

/// Zero torque at once, without the timer.
pub fn stop() {
    DAC.stop();
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
            $crate::board::stm32::output::Setup::BRIDGE;
        $crate::not_for_the_dac!(
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

/// A compile error, except in the programs that cargo builds beside the tests on a board.
#[cfg(not(feature = "on-target"))]
#[doc(hidden)]
#[macro_export]
macro_rules! not_for_the_dac {
    ($why:literal) => {
        compile_error!($why);
    };
}

/// No error beside the tests on a board: such a program ends at its start.
#[cfg(feature = "on-target")]
#[doc(hidden)]
#[macro_export]
macro_rules! not_for_the_dac {
    ($why:literal) => {};
}
