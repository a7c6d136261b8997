//! The DAC, and the line that switches an amplifier outside of the board.

use super::Pace;
use crate::board::stm32::start::halt_with;
use crate::board::stm32::wiring::{AMPLIFIER, DAC};
use crate::build_error::BuildError;
use crate::current::TorqueSource;
use crate::dac::DacCode;
use crate::fault::Fault;
use crate::output_timing::OutputTiming;
use crate::power_reading::PowerReading;
use crate::torque_output::TorqueOutput;

/// What this output has to know of a program: whether it is for this output.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    is_served: bool,
}

impl Setup {
    /// Of a program whose torque is the DAC's.
    pub const DAC: Self = Self { is_served: true };
    /// Of one whose scene has the latency of a bridge. It does not run: cargo builds all programs beside the tests
    /// on a board, and none of them is flashed.
    pub const BRIDGE: Self = Self { is_served: false };

    /// None: of an amplifier outside it is unknown.
    pub const fn torque_source(&self) -> Option<TorqueSource> {
        None
    }
}

/// The output.
#[derive(Debug)]
pub struct Output(());

impl Output {
    /// The output, and the timer that paces the servo; neither runs yet.
    ///
    /// # Errors
    /// Where the board cannot pace the period in s: see [`period`](crate::period::check).
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

    /// Has a timer latch the DAC, which holds mid-scale, and begins to pace.
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

    /// An amplifier outside says nothing.
    #[inline(always)]
    fn fault(&mut self) -> Option<Fault> {
        None
    }
}

/// Takes the motor's supply away: one write, in any state of the program.
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

/// The DAC needs to know nothing of a program, and drives no motor that is the bridge's.
#[doc(hidden)]
#[macro_export]
macro_rules! board_output {
    ([]) => {
        /// What the output has to know of this program.
        const OUTPUT: $crate::board::stm32::output::Setup =
            $crate::board::stm32::output::Setup::DAC;
    };
    ([$current_loop:ident]) => {
        /// What the output has to know of this program.
        const OUTPUT: $crate::board::stm32::output::Setup =
            $crate::board::stm32::output::Setup::BRIDGE;
        $crate::not_for_the_dac!(
            "the latency of this scene is that of a board's own bridge, and its program drives the DAC: \
             build it for a board with a bridge (--board b-g431b-esc1 --output bridge)"
        );
    };
}

/// A sweep measures the torque that it is given.
#[doc(hidden)]
#[macro_export]
macro_rules! sweep_output {
    ($bridge:tt) => {
        $crate::board_output!([]);
    };
}

/// A compile error, but for the programs that cargo builds beside the tests on a board.
#[cfg(not(feature = "on-target"))]
#[doc(hidden)]
#[macro_export]
macro_rules! not_for_the_dac {
    ($why:literal) => {
        compile_error!($why);
    };
}

/// Nothing beside the tests on a board: such a program ends at its start.
#[cfg(feature = "on-target")]
#[doc(hidden)]
#[macro_export]
macro_rules! not_for_the_dac {
    ($why:literal) => {};
}
