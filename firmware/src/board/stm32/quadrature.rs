//! The encoder on a timer in quadrature mode: the hardware counts at any speed, and a tick reads the count.

use embassy_stm32::pac::timer::vals::FilterValue;
use embassy_stm32::pac::timer::{TimGp16, TimGp32};
use embassy_stm32::timer::qei::{Config, QeiMode};

use super::wiring::ENCODER_PULL;
use crate::board::input_filter::InputFilter;
use crate::encoder::{CounterWidth, RawCount};

/// All four edges of the two channels count.
pub fn config() -> Config {
    let mut config = Config::default();
    (config.ch1_pull, config.ch2_pull) = (ENCODER_PULL, ENCODER_PULL);
    config.mode = QeiMode::Mode3;
    config
}

/// A timer that counts an encoder.
pub trait Counter: Copy {
    /// The width of the counter.
    const WIDTH: CounterWidth;

    /// The count.
    fn count(self) -> RawCount;

    /// Completes the driver's set-up: the full range, and a filter against short pulses.
    fn complete(self, filter: InputFilter);

    /// Makes the present position zero.
    fn zero(self);
}

impl Counter for TimGp32 {
    const WIDTH: CounterWidth = CounterWidth::Bits32;

    #[inline(always)]
    fn count(self) -> RawCount {
        RawCount::from(self.cnt().read())
    }

    fn complete(self, filter: InputFilter) {
        self.arr().write_value(u32::MAX);
        self.ccmr_input(0).modify(|w| {
            w.set_icf(0, FilterValue::from_bits(filter.bits()));
            w.set_icf(1, FilterValue::from_bits(filter.bits()));
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

    fn complete(self, filter: InputFilter) {
        self.ccmr_input(0).modify(|w| {
            w.set_icf(0, FilterValue::from_bits(filter.bits()));
            w.set_icf(1, FilterValue::from_bits(filter.bits()));
        });
    }

    fn zero(self) {
        self.cnt().write(|w| w.set_cnt(0));
    }
}
