//! A placeholder for the motor in a program for the DAC, so that it compiles. It does not run: cargo builds
//! all programs beside the tests on a board, and none of them is flashed.

use super::Setup;
use crate::board::stm32::start::halt_with;
use crate::board::stm32::wiring::POWER_STAGE;
use crate::current::{CurrentLoop, Drive, Motor, Supply, Winding};
use crate::encoder::CounterWidth;
use crate::transducers::Transducers;

impl Setup {
    /// The set-up of a program for the DAC.
    pub const DAC: Self =
        Self { current_loop: &NO_MOTOR, fill: |_| halt_with("its torque, which is the DAC's") };
}

/// An arbitrary current loop.
static NO_MOTOR: CurrentLoop = {
    let winding = Winding::Brushed;
    let motor = Motor { winding, resistance: 1.0, inductance: 1e-3, torque_constant: 1.0 };
    let supply = Supply::sinking(12.0, 12.0);
    let drive = Drive { motor, supply, bandwidth: 100.0, largest_temperature: 80.0 };
    let transducers = Transducers {
        counts_per_turn: 4096.0,
        counter: CounterWidth::Bits16,
        full_scale_torque: 1.0,
        largest_speed: 1.0,
    };
    CurrentLoop::checked(&drive, &POWER_STAGE, &transducers, 1e-3)
};
