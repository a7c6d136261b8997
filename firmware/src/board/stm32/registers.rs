//! The board as the servo sees it: each thing a register or two.

use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::Key;

use super::pace::{Pace, Period};
use super::quadrature::Counter;
use super::wiring::{AMPLIFIER, CONVERTER, ENCODER};
use crate::board::period::{PATIENCE, WATCHDOG_CLOCK};
use crate::board::retained;
use crate::boot::Startup;
use crate::cycle::Hardware;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::Retained;

/// The registers that belong to the servo's interrupt.
pub struct Registers {
    pace: Pace,
    period: Period,
}

impl Registers {
    /// Prepares the pacing timer; it does not run yet.
    pub fn new(period: Period) -> Self {
        Self { pace: Pace::prepare(period), period }
    }

    /// Begins to pace. The interrupt's handler must find its place filled from here on.
    pub fn start(&mut self) {
        self.pace.start();
    }
}

impl Hardware for Registers {
    #[inline(always)]
    fn count(&mut self) -> RawCount {
        ENCODER.count()
    }

    #[inline(always)]
    fn write(&mut self, code: DacCode) {
        CONVERTER.write(code);
    }

    #[inline(always)]
    fn amplifier(&mut self, on: bool) {
        AMPLIFIER.set(on);
    }

    #[inline(always)]
    fn passed(&mut self) -> u32 {
        self.pace.passed()
    }

    #[inline(always)]
    fn elapsed(&mut self) -> u32 {
        self.pace.elapsed()
    }

    #[inline(always)]
    fn feed(&mut self) {
        pac::IWDG.kr().write(|w| w.set_key(Key::RESET));
    }

    fn keep(&mut self, record: &[u32; Retained::WORDS]) {
        retained::keep(record);
    }
}

/// Bit of the chips' reset causes that says that the watchdog was it; the F4's and the G4's is the
/// same, under two names.
const BY_WATCHDOG: u32 = 1 << 29;

impl Startup for Registers {
    fn zero(&mut self) {
        ENCODER.zero();
    }

    fn guard(&mut self) {
        // A count more makes up for what the cast rounds down.
        let counts = PATIENCE * self.period.seconds() * WATCHDOG_CLOCK + 1.0;
        pac::IWDG.kr().write(|w| w.set_key(Key::START));
        pac::IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        pac::IWDG.rlr().write(|w| w.set_rl(counts as u16));
    }

    fn kept(&mut self) -> [u32; Retained::WORDS] {
        retained::kept()
    }

    fn was_reset_by_watchdog(&mut self) -> bool {
        let by_watchdog = pac::RCC.csr().read().0 & BY_WATCHDOG != 0;
        // Told once: the next reset may have another cause.
        pac::RCC.csr().modify(|w| w.set_rmvf(true));
        by_watchdog
    }

    fn period(&self) -> u32 {
        self.period.clock_counts().get()
    }
}
