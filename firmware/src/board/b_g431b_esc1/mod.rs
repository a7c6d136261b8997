//! B-G431B-ESC1: STM32G431CB at 170 MHz.
//!
//! Facts of the chip are from its datasheet (DS12589) and reference manual (RM0440), facts of the
//! board from its user manual (UM2516, table 4) and the schematic of MB1419.
//!
//! With the feature `bridge` the board's own power stage drives the motor. Without the feature the power
//! stage stays off, with all six inputs of its gate drivers driven low, and the DAC commands an external
//! current amplifier, although both pins of the DAC have other purposes on this board (see `counter.rs`).
//!
//! The encoder and the serial port share pins, and are wired together: an incremental encoder, and the port at the debug
//! probe (`counter.rs`), or, with the feature `magnetic` and the bridge, a chip in place of that port (`magnetic.rs`).

#[cfg_attr(not(feature = "magnetic"), path = "counter.rs")]
#[cfg_attr(feature = "magnetic", path = "magnetic.rs")]
mod encoder;

use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::rcc::PllPreDiv;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::Timer;
use embassy_stm32::{Config, Peripherals, pac};
#[cfg(feature = "bridge")]
pub use encoder::*;

use crate::board::stm32::clock_170;
use crate::board::stm32::output::OutputPin;
#[cfg(feature = "bridge")]
use crate::board::stm32::output::gates::{Gate, Gates};
use crate::board::stm32::serial::Serial;

/// The board's name as a feature and for `haptic flash`.
pub const NAME: &str = "b-g431b-esc1";
/// The chip's name for debug probes.
pub const CHIP: &[u8; 13] = b"STM32G431CBUx";

/// The encoder: TIM4, the timer of PB6 and PB7, which are the pads A+ and B+ of J8. It has 16 bits;
/// the chip's only quadrature timer with 32, TIM2, has no pad with both its inputs.
pub const ENCODER: pac::timer::TimGp16 = pac::TIM4;
/// The clock of the slow bus's timers in Hz: TIM4 counts and samples with it, TIM6 and TIM2 pace the servo.
pub const TIMER_CLOCK: f64 = clock_170::CLOCK;
/// The pads tolerate 5 V without the chip's own pull (DS12589), and the board pulls them up by 10 kΩ.
pub const ENCODER_PULL: Pull = Pull::None;
/// The clock that measures the lateness of the servo: TIM2, which has 32 bits.
pub const CLOCK: pac::timer::TimGp32 = pac::TIM2;
/// The amplifier: PA15, which is the pad PWM of J3, the only pad that neither the encoder nor the serial port
/// uses. In reset it belongs to the debug port, and the chip pulls it up by 25 to 55 kΩ: the resistor from
/// the amplifier's input to ground must be 2.2 kΩ, which leaves 0.3 V at most.
pub const AMPLIFIER: OutputPin = OutputPin { port: pac::GPIOA, pin: 15 };

/// The power stage.
#[cfg(feature = "bridge")]
pub use crate::current::B_G431B_ESC1 as POWER_STAGE;

/// The gates of the bridge: TIM1's channels and complementary channels, which are the high sides and the low
/// sides of the phases U, V and W (UM2516, table 4; alternate functions by DS12589).
#[cfg(feature = "bridge")]
pub const GATES: Gates = Gates([
    [Gate::new(pac::GPIOA, 8, 6), Gate::new(pac::GPIOC, 13, 4)],
    [Gate::new(pac::GPIOA, 9, 6), Gate::new(pac::GPIOA, 12, 6)],
    [Gate::new(pac::GPIOA, 10, 6), Gate::new(pac::GPIOB, 15, 4)],
]);

/// 170 MHz from the board's 8 MHz crystal.
pub fn clocks() -> Config {
    clock_170::from_crystal(Hertz(8_000_000), PllPreDiv::DIV2)
}

/// Configures each pin; the amplifier is off. Returns the port to the host.
pub fn connect_pins(mut chip: Peripherals) -> Serial {
    // The drivers set up clocks and pins and would undo this when dropped; from here on the servo uses the
    // registers.
    core::mem::forget((
        // The gate drivers, high sides and low sides of the phases U, V and W (L6387, UM2516): low is
        // off. In reset the chip leaves them to the drivers' own resistors to ground.
        [
            Output::new(chip.PA8.reborrow(), Level::Low, Speed::Low),
            Output::new(chip.PA9.reborrow(), Level::Low, Speed::Low),
            Output::new(chip.PA10.reborrow(), Level::Low, Speed::Low),
            Output::new(chip.PC13.reborrow(), Level::Low, Speed::Low),
            Output::new(chip.PA12.reborrow(), Level::Low, Speed::Low),
            Output::new(chip.PB15.reborrow(), Level::Low, Speed::Low),
        ],
        Timer::new(chip.TIM2.reborrow()),
        Timer::new(chip.TIM6.reborrow()),
        Timer::new(chip.TIM7.reborrow()),
    ));
    encoder::connect(chip)
}
