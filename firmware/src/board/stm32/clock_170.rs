//! The clock tree of the boards with a G4 chip.

use embassy_stm32::Config;
use embassy_stm32::pac::flash::vals::Latency;
use embassy_stm32::pac::{FLASH, RCC};
use embassy_stm32::rcc::{
    AHBPrescaler, Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;

/// The clock of core, buses and timers in Hz, after [`undivide`].
pub const CLOCK: f64 = 170e6;

/// A system clock of 170 MHz, the maximum of a G4, from a crystal: the internal oscillator may be off by one
/// per cent, and so would every damping. `prediv` divides the crystal's frequency to 4 MHz for the multiplier.
///
/// The core has half of it until [`undivide`].
pub fn from_crystal(crystal: Hertz, prediv: PllPreDiv) -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: crystal, mode: HseMode::Oscillator });
    config.rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv,
        mul: PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(PllRDiv::DIV2),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    // Above 150 MHz the core needs the boosted voltage.
    config.rcc.boost = true;
    config.rcc.ahb_pre = AHBPrescaler::DIV2;
    // The port's clock is the same before and after.
    config.rcc.mux.usart2sel = mux::Uartsel::SYS;
    config
}

/// Gives the core the whole system clock, a microsecond after the switch to it: from 16 MHz the core must not go
/// beyond 80 MHz at once, for the sake of the voltage (RM0440, system clock selection; ST's own driver takes the
/// same two steps).
pub fn undivide() {
    FLASH.acr().modify(|w| w.set_latency(Latency::WS4));
    while FLASH.acr().read().latency() != Latency::WS4 {}
    cortex_m::asm::delay(CLOCK as u32 / 2_000_000);
    RCC.cfgr().modify(|w| w.set_hpre(AHBPrescaler::DIV1));
}
