//! The clock tree of the boards with a G4 chip.

use embassy_stm32::Config;
use embassy_stm32::rcc::{Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk};
use embassy_stm32::time::Hertz;

/// 170 MHz, the maximum of a G4, from a crystal: the internal oscillator may be off by one per cent, and so
/// would every damping. `prediv` divides the crystal's frequency to 4 MHz for the multiplier.
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
    config
}
