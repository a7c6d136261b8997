//! The board as the servo sees it: each thing a register or two.

use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::Key;

use super::pace::{Pace, Period};
use super::quadrature::Counter;
use super::wiring::{AMPLIFIER, CONVERTER, ENCODER};
use super::{family, reset};
use crate::board::retained;
use crate::boot::Startup;
use crate::cycle::Hardware;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::Retained;
use crate::period::{PATIENCE, WATCHDOG_CLOCK};
use crate::reset::ResetCause;

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

impl Startup for Registers {
    fn zero(&mut self) {
        ENCODER.zero();
    }

    fn guard(&mut self) {
        // While the core is halted the converter holds its last code: what takes that away shall not
        // be halted with it.
        family::keep_watchdog_running();
        // A count more makes up for what the cast rounds down.
        let counts = PATIENCE * self.period.seconds() * WATCHDOG_CLOCK + 1.0;
        pac::IWDG.kr().write(|w| w.set_key(Key::START));
        pac::IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        pac::IWDG.rlr().write(|w| w.set_rl(counts as u16));
    }

    fn kept(&mut self) -> [u32; Retained::WORDS] {
        retained::kept()
    }

    fn reset_cause(&mut self) -> ResetCause {
        reset::cause()
    }

    fn period(&self) -> u32 {
        self.period.clock_counts().get()
    }
}
