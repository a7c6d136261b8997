//! The encoder on a timer in quadrature mode: the hardware counts, at any speed, and a tick reads.

use embassy_stm32::gpio::Pull;
use embassy_stm32::pac::timer::vals::FilterValue;
use embassy_stm32::pac::timer::{TimGp16, TimGp32};
use embassy_stm32::timer::qei::{Config, QeiMode};

use crate::encoder::{CounterWidth, RawCount};

/// All four edges of the two channels count. The pull-ups serve encoders with open collectors and
/// keep the lines of one that is not plugged in from counting noise.
pub fn config() -> Config {
    let mut config = Config::default();
    (config.ch1_pull, config.ch2_pull) = (Pull::Up, Pull::Up);
    config.mode = QeiMode::Mode3;
    config
}

/// A timer that counts an encoder.
pub trait Counter: Copy {
    /// Bits after which it wraps.
    const WIDTH: CounterWidth;

    /// What it has counted.
    fn count(self) -> RawCount;

    /// Finishes what the driver began: the full range, and a filter against short spikes.
    fn complete(self);

    /// Makes the present position zero.
    fn zero(self);
}

/// Eight equal samples in a row at the timer's clock, 47 ns at 170 MHz: spikes from a motor's
/// commutation are shorter, and edges of a million counts a second twenty times longer.
const FILTER: FilterValue = FilterValue::FCK_INT_N8;

impl Counter for TimGp32 {
    const WIDTH: CounterWidth = CounterWidth::Bits32;

    #[inline(always)]
    fn count(self) -> RawCount {
        RawCount::from(self.cnt().read())
    }

    fn complete(self) {
        self.arr().write_value(u32::MAX);
        self.ccmr_input(0).modify(|w| {
            w.set_icf(0, FILTER);
            w.set_icf(1, FILTER);
        });
    }

    fn zero(self) {
        self.cnt().write_value(0);
    }
}

impl Counter for TimGp16 {
    const WIDTH: CounterWidth = CounterWidth::Bits16;

    #[inline(always)]
    fn count(self) -> RawCount {
        RawCount::from(self.cnt().read().cnt())
    }

    fn complete(self) {
        self.ccmr_input(0).modify(|w| {
            w.set_icf(0, FILTER);
            w.set_icf(1, FILTER);
        });
    }

    fn zero(self) {
        self.cnt().write(|w| w.set_cnt(0));
    }
}
