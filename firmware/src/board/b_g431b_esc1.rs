//! B-G431B-ESC1: STM32G431CB at 170 MHz.
//!
//! Facts of the chip are from its datasheet (DS12589) and reference manual (RM0440), facts of the
//! board from its user manual (UM2516, table 4) and the schematic of MB1419.
//!
//! With the feature `bridge` the board's own power stage drives the motor. Without the feature the power
//! stage stays off, with all six inputs of its gate drivers driven low, and the DAC commands an external
//! current amplifier, although both pins of the DAC have other purposes on this board (see [`connect_pins`]).
//!
//! With the feature `magnetic`, and the bridge, the chip of an encoder is at the pads TX, RX and PWM of J3, without the
//! board's resistors R23 and R24, and the serial port at A+ and B+ of J8.

use embassy_stm32::gpio::{Level, Output, Pull, Speed};
#[cfg(feature = "magnetic")]
use embassy_stm32::peripherals::USART1 as SerialPort;
#[cfg(not(feature = "magnetic"))]
use embassy_stm32::peripherals::USART2 as SerialPort;
use embassy_stm32::rcc::PllPreDiv;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::Timer;
#[cfg(not(feature = "magnetic"))]
use embassy_stm32::timer::qei::Qei;
use embassy_stm32::usart::BufferedInterruptHandler;
use embassy_stm32::{Config, Peripherals, bind_interrupts, pac};

use super::stm32::clock_170;
#[cfg(feature = "magnetic")]
use super::stm32::magnetic::{Bus, BusPin};
use super::stm32::output::OutputPin;
#[cfg(all(feature = "bridge", not(feature = "magnetic")))]
use super::stm32::output::bridge::encoder::quadrature::IndexPin;
#[cfg(feature = "bridge")]
use super::stm32::output::gates::{Gate, Gates};
#[cfg(not(feature = "magnetic"))]
use super::stm32::quadrature;
use super::stm32::serial::{self, Serial};

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

/// The encoder's index: TIM4_CH3 on PB8, which is the pad Z+ of J8 (alternate function by DS12589). The board
/// pulls it up like A+ and B+.
#[cfg(all(feature = "bridge", not(feature = "magnetic")))]
pub const INDEX: IndexPin = IndexPin { port: pac::GPIOB, pin: 8, function: 2 };

/// The bus of a magnetic encoder: SPI3 on the pins of the board's serial port and of the pad PWM (alternate functions
/// by DS12589, requests of the DMA by RM0440's table of the multiplexer). MOSI's pin switches the dividers of the
/// back-EMF, which the bridge does not use.
#[cfg(feature = "magnetic")]
pub const BUS: Bus = Bus {
    spi: pac::SPI3,
    select: BusPin { port: pac::GPIOA, pin: 15, function: 6 },
    clock: BusPin { port: pac::GPIOB, pin: 3, function: 6 },
    input: BusPin { port: pac::GPIOB, pin: 4, function: 6 },
    output: BusPin { port: pac::GPIOB, pin: 5, function: 6 },
    received: 14,
    wants: 15,
    // TIM1's channel 4.
    begins: 45,
    enable: || pac::RCC.apb1enr1().modify(|w| w.set_spi3en(true)),
    reset: || {
        pac::RCC.apb1rstr1().modify(|w| w.set_spi3rst(true));
        pac::RCC.apb1rstr1().modify(|w| w.set_spi3rst(false));
    },
};

#[cfg(not(feature = "magnetic"))]
bind_interrupts!(struct Interrupts {
    USART2 => BufferedInterruptHandler<SerialPort>;
});

#[cfg(feature = "magnetic")]
bind_interrupts!(struct Interrupts {
    USART1 => BufferedInterruptHandler<SerialPort>;
});

/// 170 MHz from the board's 8 MHz crystal.
pub fn clocks() -> Config {
    clock_170::from_crystal(Hertz(8_000_000), PllPreDiv::DIV2)
}

/// Configures each pin; the amplifier is off. Returns the port to the host.
pub fn connect_pins(chip: Peripherals) -> Serial {
    // The drivers set up clocks and pins and would undo this when dropped; from here on the servo uses the
    // registers.
    // The magnetic encoder's bus selects its chip with PA15, and takes the pins of the serial port.
    #[cfg(not(feature = "magnetic"))]
    core::mem::forget((
        Output::new(chip.PA15, Level::Low, Speed::Low),
        Qei::new(chip.TIM4, chip.PB6, chip.PB7, quadrature::config()),
    ));
    core::mem::forget((
        // The gate drivers, high sides and low sides of the phases U, V and W (L6387, UM2516): low is
        // off. In reset the chip leaves them to the drivers' own resistors to ground.
        [
            Output::new(chip.PA8, Level::Low, Speed::Low),
            Output::new(chip.PA9, Level::Low, Speed::Low),
            Output::new(chip.PA10, Level::Low, Speed::Low),
            Output::new(chip.PC13, Level::Low, Speed::Low),
            Output::new(chip.PA12, Level::Low, Speed::Low),
            Output::new(chip.PB15, Level::Low, Speed::Low),
        ],
        Timer::new(chip.TIM2),
        Timer::new(chip.TIM6),
        Timer::new(chip.TIM7),
    ));
    // The board uses PA4 to sense the back-EMF of its phase 1, so there is no pad: the wire to the amplifier is
    // soldered to the pin's side of that divider, and nothing is connected to the board's motor output 1. Channel
    // 2's pin PA5 is in the middle of a current sense amplifier.
    #[cfg(not(feature = "bridge"))]
    super::stm32::output::dac::connect(chip.DAC1, chip.PA4);
    // The virtual serial port of the board's debug probe; without the probe, the pads TX and RX of J3, or of J8.
    #[cfg(not(feature = "magnetic"))]
    return serial::open(chip.USART2, chip.PB4, chip.PB3, Interrupts);
    #[cfg(feature = "magnetic")]
    serial::open(chip.USART1, chip.PB7, chip.PB6, Interrupts)
}
