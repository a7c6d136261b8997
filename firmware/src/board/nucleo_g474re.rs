//! NUCLEO-G474RE: STM32G474RE at 170 MHz.
//!
//! Facts of the chip are from its datasheet (DS12288) and reference manual (RM0440), facts of the
//! board from its user manual (UM2505).

use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::peripherals::USART2;
use embassy_stm32::rcc::PllPreDiv;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::Timer;
use embassy_stm32::timer::qei::Qei;
use embassy_stm32::usart::BufferedInterruptHandler;
use embassy_stm32::{Config, Peripherals, bind_interrupts, pac};

#[cfg(feature = "magnetic")]
use super::stm32::magnetic::{Bus, BusPin};
use super::stm32::output::OutputPin;
use super::stm32::serial::{self, Serial};
use super::stm32::{clock_170, quadrature};

/// The board's name as a feature and for `haptic flash`.
pub const NAME: &str = "nucleo-g474re";
/// The chip's name for debug probes.
pub const CHIP: &[u8; 13] = b"STM32G474RETx";

/// The encoder: TIM2, one of the chip's two timers with 32 bits and quadrature inputs.
pub const ENCODER: pac::timer::TimGp32 = pac::TIM2;
/// The clock of the slow bus's timers in Hz: TIM2 counts and samples with it, TIM6 paces the servo.
pub const TIMER_CLOCK: f64 = clock_170::CLOCK;
/// PA0 and PA1 tolerate at most 3.6 V (DS12288), so the encoder must not have 5 V outputs. The inputs are
/// pulled up for open collectors, and so that an unplugged encoder counts no noise.
pub const ENCODER_PULL: Pull = Pull::Up;
/// The clock that measures the lateness of the servo: TIM5, the other timer with 32 bits.
pub const CLOCK: pac::timer::TimGp32 = pac::TIM5;
/// The amplifier: PB10, which is D6 on the Arduino header. It floats while the chip is in reset, so
/// the amplifier's input needs a pull-down resistor.
pub const AMPLIFIER: OutputPin = OutputPin { port: pac::GPIOB, pin: 10 };

// The certificate's phases leave room for transfers at this clock.
#[cfg(feature = "magnetic")]
const _: () = assert!(TIMER_CLOCK == crate::magnetic::AT_COUNT_CLOCK);

/// The bus of a magnetic encoder: SPI2 on the morpho header, which the DAC, the LED and the serial port leave free
/// (alternate functions by DS12288, requests of the DMA by RM0440's table of the multiplexer).
#[cfg(feature = "magnetic")]
pub const BUS: Bus = Bus {
    spi: pac::SPI2,
    select: BusPin { port: pac::GPIOB, pin: 12, function: 5 },
    clock: BusPin { port: pac::GPIOB, pin: 13, function: 5 },
    input: BusPin { port: pac::GPIOB, pin: 14, function: 5 },
    output: BusPin { port: pac::GPIOB, pin: 15, function: 5 },
    received: 12,
    wants: 13,
    // TIM6's.
    begins: 8,
    enable: || pac::RCC.apb1enr1().modify(|w| w.set_spi2en(true)),
    reset: || {
        pac::RCC.apb1rstr1().modify(|w| w.set_spi2rst(true));
        pac::RCC.apb1rstr1().modify(|w| w.set_spi2rst(false));
    },
};

bind_interrupts!(struct Interrupts {
    USART2 => BufferedInterruptHandler<USART2>;
});

/// 170 MHz from the board's 24 MHz crystal X3.
pub fn clocks() -> Config {
    clock_170::from_crystal(Hertz(24_000_000), PllPreDiv::DIV6)
}

/// Configures each pin; the amplifier is off. Returns the port to the host.
pub fn connect_pins(chip: Peripherals) -> Serial {
    // The drivers set up clocks and pins and would undo this when dropped; from here on the servo uses the
    // registers.
    core::mem::forget((
        Output::new(chip.PB10, Level::Low, Speed::Low),
        // A0 and A1 on the Arduino header.
        Qei::new(chip.TIM2, chip.PA0, chip.PA1, quadrature::config()),
        Timer::new(chip.TIM5),
        Timer::new(chip.TIM6),
        Timer::new(chip.TIM7),
    ));
    // The DAC's pin is A2 on the Arduino header. Channel 2's pin PA5 drives the board's LED.
    super::stm32::output::dac::connect(chip.DAC1, chip.PA4);
    // The virtual serial port of the board's debug probe.
    serial::open(chip.USART2, chip.PA3, chip.PA2, Interrupts)
}
