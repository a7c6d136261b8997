//! The board as the servo sees it: each thing a register or two.

use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::Key;

use super::quadrature::Counter;
use super::tick_timer::{Period, TickTimer};
use super::wiring::{AMPLIFIER, DAC, ENCODER};
use super::{family, reset};
use crate::board::fault_memory;
use crate::boot::Startup;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::FaultRecord;
use crate::output_timing::OutputTiming;
use crate::period::{PATIENCE, WATCHDOG_CLOCK};
use crate::reset::ResetCause;
use crate::servo_loop::Hardware;

/// The registers that belong to the servo's interrupt.
pub struct Registers {
    pace: TickTimer,
    period: Period,
}

impl Registers {
    /// Prepares the pacing timer, and what latches the DAC; neither runs yet.
    pub fn new(period: Period, timing: OutputTiming) -> Self {
        Self { pace: TickTimer::prepare(period, timing), period }
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
        DAC.write(code);
    }

    #[inline(always)]
    fn amplifier(&mut self, on: bool) {
        AMPLIFIER.set(on);
    }

    #[inline(always)]
    fn periods_since_last(&mut self) -> u32 {
        self.pace.periods_since_last()
    }

    #[inline(always)]
    fn time_in_period(&mut self) -> u32 {
        self.pace.time_in_period()
    }

    #[inline(always)]
    fn feed_watchdog(&mut self) {
        pac::IWDG.kr().write(|w| w.set_key(Key::RESET));
    }

    fn store_fault(&mut self, record: &[u32; FaultRecord::WORDS]) {
        fault_memory::store(record);
    }
}

impl Startup for Registers {
    fn zero_encoder(&mut self) {
        ENCODER.zero();
    }

    fn start_watchdog(&mut self) {
        // While the core is halted the DAC holds its last code: what takes that away shall not
        // be halted with it.
        family::keep_watchdog_running();
        // A count more covers the cast's rounding.
        let counts = PATIENCE * self.period.seconds() * WATCHDOG_CLOCK + 1.0;
        pac::IWDG.kr().write(|w| w.set_key(Key::START));
        pac::IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        pac::IWDG.rlr().write(|w| w.set_rl(counts as u16));
    }

    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS] {
        fault_memory::stored()
    }

    fn reset_cause(&mut self) -> ResetCause {
        reset::cause()
    }

    fn period(&self) -> u32 {
        self.period.clock_counts().get()
    }
}
