//! The clock tree that the boards with a G4 chip have in common.

use embassy_stm32::Config;
use embassy_stm32::rcc::{Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk};
use embassy_stm32::time::Hertz;

/// 170 MHz, the most of a G4, from a crystal: the internal oscillator would be off by a per cent,
/// and with it every damping. `prediv` takes the crystal to the 4 MHz that the multiplier wants.
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
    // Above 150 MHz the core needs the higher voltage.
    config.rcc.boost = true;
    config
}
