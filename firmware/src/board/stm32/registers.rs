//! The servo's hardware: each access is one or two registers.

use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::Key;

#[cfg(feature = "magnetic")]
use super::magnetic;
use super::output::{self, Output, Pace, Setup};
#[cfg(not(feature = "magnetic"))]
use super::quadrature::Counter;
#[cfg(not(feature = "magnetic"))]
use super::wiring::ENCODER;
use super::{family, reset};
use crate::board::fault_memory;
use crate::boot::Startup;
use crate::build_error::BuildError;
use crate::dac::DacCode;
use crate::encoder::RawCount;
#[cfg(any(feature = "bridge", feature = "magnetic"))]
use crate::fault::Fault;
use crate::fault::FaultRecord;
#[cfg(feature = "magnetic")]
use crate::magnetic::{ReadingError, Rests};
use crate::output_timing::OutputTiming;
use crate::period;
use crate::reset::ResetCause;
#[cfg(all(feature = "magnetic", not(feature = "bridge")))]
use crate::servo_loop::BEGAN_LATE;
use crate::servo_loop::Hardware;
#[cfg(feature = "bridge")]
use crate::servo_loop::OutputEvent;

/// The registers of the servo's interrupt. After `FROZEN` ticks without a step the encoder has stopped; 0: it may rest.
pub struct Registers<const FROZEN: u32 = 0> {
    pace: Pace,
    output: Output,
    #[cfg(feature = "magnetic")]
    rests: Rests,
}

impl<const FROZEN: u32> Registers<FROZEN> {
    /// Prepares the pace of the servo and the torque output; neither runs yet.
    ///
    /// # Errors
    /// If the board cannot pace the period in s.
    pub fn new(setup: Setup, period: f64, timing: OutputTiming) -> Result<Self, BuildError> {
        let (output, pace) = Output::new(setup, period, timing)?;
        Ok(Self {
            pace,
            output,
            #[cfg(feature = "magnetic")]
            rests: Rests::default(),
        })
    }

    /// Starts the timers. The servo's interrupt must be enabled within a period.
    pub fn start(&mut self, timing: OutputTiming) {
        #[cfg(feature = "magnetic")]
        magnetic::start(cfg!(not(feature = "bridge")));
        self.output.start(&mut self.pace, timing);
    }

    /// After missed updates, or where the tick begins late, which may be in the transfer of the next update.
    #[cfg(feature = "magnetic")]
    #[cold]
    #[inline(never)]
    fn after_gap(&mut self, passed: u32) {
        if FROZEN > 0 {
            self.rests.miss(passed.saturating_sub(1));
        }
        #[cfg(not(feature = "bridge"))]
        {
            self.pace.doubt(false);
            if passed != BEGAN_LATE {
                magnetic::take_again(|| self.pace.elapsed());
            }
        }
    }

    /// Takes the reading of the transfer that has ended; whether there is a tick with it.
    #[cfg(all(feature = "magnetic", not(feature = "bridge")))]
    #[inline(always)]
    pub fn take_reading(&mut self, setup: &'static magnetic::Setup) -> bool {
        magnetic::take_ended(setup, || self.pace.doubt(true))
    }
}

impl<const FROZEN: u32> Hardware for Registers<FROZEN> {
    #[inline(always)]
    fn count(&mut self) -> RawCount {
        output::count()
    }

    #[inline(always)]
    fn write(&mut self, code: DacCode) {
        self.output.set(code);
    }

    #[inline(always)]
    fn amplifier(&mut self, on: bool) {
        self.output.switch(on);
    }

    #[cfg(feature = "bridge")]
    #[inline(always)]
    fn output_event(&mut self) -> Option<OutputEvent> {
        self.output.event()
    }

    #[cfg(feature = "magnetic")]
    fn reading_fault(&mut self) -> Option<Fault> {
        #[cfg(feature = "bridge")]
        return output::bridge::reading_fault();
        #[cfg(not(feature = "bridge"))]
        magnetic::fault()
    }

    #[cfg(feature = "magnetic")]
    #[inline(always)]
    fn rested(&mut self, tick: u32) -> bool {
        FROZEN > 0 && self.rests.take(tick, FROZEN)
    }

    #[cfg(feature = "magnetic")]
    fn stopped(&self) -> Option<Fault> {
        let stopped = FROZEN > 0 && self.rests.are(FROZEN);
        stopped.then(|| Fault::EncoderReading {
            error: ReadingError::Frozen as u32,
            allowed: FROZEN - 1,
        })
    }

    #[cfg(feature = "bridge")]
    fn start_up_ticks(&self) -> u32 {
        self.output.start_up_ticks()
    }

    #[cfg(feature = "bridge")]
    fn align(&mut self) -> Result<(), Fault> {
        self.output.align()
    }

    #[cfg(feature = "bridge")]
    fn is_aligning(&mut self) -> bool {
        self.output.is_aligning()
    }

    #[inline(always)]
    fn periods_since_last(&mut self) -> u32 {
        let passed = self.pace.begun_by(output::period_began());
        #[cfg(feature = "magnetic")]
        if passed != 1 {
            self.after_gap(passed);
        }
        passed
    }

    /// The reading of the transfer, or of that after it.
    #[cfg(all(feature = "magnetic", not(feature = "bridge")))]
    #[inline(always)]
    fn sample(&mut self) -> (u32, RawCount) {
        let count = self.count();
        match self.periods_since_last() {
            1 => (1, count),
            passed => (passed, self.count()),
        }
    }

    #[inline(always)]
    fn time_in_period(&mut self) -> u32 {
        self.pace.elapsed()
    }

    /// The update itself takes the reading.
    #[cfg(feature = "magnetic")]
    fn lateness_of_count(&mut self) -> u32 {
        0
    }

    #[inline(always)]
    fn feed_watchdog(&mut self) {
        pac::IWDG.kr().write(|w| w.set_key(Key::RESET));
    }

    fn store_fault(&mut self, record: &[u32; FaultRecord::WORDS]) {
        fault_memory::store(record);
    }
}

impl<const FROZEN: u32> Startup for Registers<FROZEN> {
    #[cfg(not(feature = "magnetic"))]
    fn zero_encoder(&mut self) {
        ENCODER.zero();
    }

    /// Its zero is its own.
    #[cfg(feature = "magnetic")]
    fn zero_encoder(&mut self) {}

    #[cfg(feature = "magnetic")]
    fn absolute_count(&mut self) -> Option<RawCount> {
        Some(magnetic::count())
    }

    fn start_watchdog(&mut self) {
        // While a debugger halts the core the DAC holds its last code, so the watchdog, which removes the
        // torque, must not halt with the core.
        family::keep_watchdog_running();
        let counts = period::watchdog_counts(self.pace.seconds());
        pac::IWDG.kr().write(|w| w.set_key(Key::START));
        pac::IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        pac::IWDG.rlr().write(|w| w.set_rl(counts));
    }

    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS] {
        fault_memory::stored()
    }

    fn reset_cause(&mut self) -> ResetCause {
        reset::cause()
    }

    fn period(&self) -> u32 {
        self.pace.counts()
    }
}
