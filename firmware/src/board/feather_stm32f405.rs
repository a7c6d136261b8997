//! Adafruit Feather STM32F405 Express: STM32F405RG at 168 MHz.
//!
//! Facts of the chip are from its datasheet (DS8626) and reference manual (RM0090), facts of the
//! board from its published schematic (`adafruit/Adafruit-Feather-STM32F405-Express-PCB`, commit f10cfb4). Each
//! pin used here is on one of the two headers, and nothing else on the board is connected to it, except a
//! resistor of 100 kOhm from RX to 3.3 V.

use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::peripherals::USART3;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::Timer;
use embassy_stm32::timer::qei::Qei;
use embassy_stm32::usart::BufferedInterruptHandler;
use embassy_stm32::{Config, Peripherals, bind_interrupts, pac};

use super::stm32::output::OutputPin;
use super::stm32::quadrature;
use super::stm32::serial::{self, Serial};

/// The board's name as a feature and for `haptic flash`.
pub const NAME: &str = "feather-stm32f405";
/// The chip's name for debug probes.
pub const CHIP: &[u8; 13] = b"STM32F405RGTx";

/// The encoder: TIM3, the timer of PC6 and PC7 (D6 and D5). It has 16 bits: of the chip's 32-bit timers, TIM2
/// has its inputs at the flash chip (PA15, PB3) or at the DAC (PA5), and TIM5 on pins without a header.
pub const ENCODER: pac::timer::TimGp16 = pac::TIM3;
/// The clock of the slow bus's timers in Hz: TIM3 counts and samples with it, TIM6 paces the servo.
pub const TIMER_CLOCK: f64 = 84e6;
/// PC6 and PC7 tolerate 5 V without the chip's own pull (DS8626), and the header supplies 5 V from USB.
pub const ENCODER_PULL: Pull = Pull::None;
/// The clock that measures the lateness of the servo: TIM5, which has 32 bits.
pub const CLOCK: pac::timer::TimGp32 = pac::TIM5;
/// The amplifier: PC3 (D11). It floats while the chip is in reset, so the amplifier's input needs a pull-down
/// resistor. PB6 and PB7 (SCL, SDA) cannot serve: the board pulls them up.
pub const AMPLIFIER: OutputPin = OutputPin { port: pac::GPIOC, pin: 3 };

bind_interrupts!(struct Interrupts {
    USART3 => BufferedInterruptHandler<USART3>;
});

/// 168 MHz, the chip's maximum, from the board's 12 MHz crystal. Timers on the slow bus count 84 MHz.
pub fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz(12_000_000), mode: HseMode::Oscillator });
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll = Some(Pll {
        // 2 MHz into the PLL, which the manual recommends against jitter.
        prediv: PllPreDiv::DIV6,
        mul: PllMul::MUL168,
        divp: Some(PllPDiv::DIV2),
        divq: None,
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    // 42 MHz and 84 MHz, the maximum of these buses.
    (config.rcc.ahb_pre, config.rcc.apb1_pre) = (AHBPrescaler::DIV1, APBPrescaler::DIV4);
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config
}

/// Configures each pin; the amplifier is off. Returns the port to the host.
pub fn connect_pins(chip: Peripherals) -> Serial {
    // The drivers set up clocks and pins and would undo this when dropped; from here on the servo uses the
    // registers.
    core::mem::forget((
        Output::new(chip.PC3, Level::Low, Speed::Low),
        Qei::new(chip.TIM3, chip.PC6, chip.PC7, quadrature::config()),
        Timer::new(chip.TIM5),
        Timer::new(chip.TIM6),
        Timer::new(chip.TIM7),
    ));
    // The DAC's pin is A0.
    super::stm32::output::dac::connect(chip.DAC1, chip.PA4);
    // RX and TX of the header.
    serial::open(chip.USART3, chip.PB11, chip.PB10, Interrupts)
}
