//! One instant of the current loop.

use core::hint::cold_path;
use core::sync::atomic::Ordering;

use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;

#[cfg(feature = "magnetic")]
use super::encoder::chip;
#[cfg(not(feature = "magnetic"))]
use super::encoder::quadrature;
use super::{
    STATE, State, WAITING, encoder, latest, off, over_current, pwm, sense, tell, tell_heat,
};
use crate::board::stm32::EncoderSetup;
use crate::board::stm32::output::pace::now;
use crate::current::{
    Alignment, AlignmentStep, CurrentController, CurrentLoop, Heating, OffsetCheck, PowerFault,
    Sample, TripSearch,
};
use crate::dac::DacCode;
#[cfg(feature = "magnetic")]
use crate::encoder::RawCount;
use crate::fault::Fault;
use crate::output_timing::OutputTiming;

/// The progress from a request to gates that are driven.
enum StartUp {
    /// Nothing is requested, or the request is new.
    Waiting,
    /// The gates are low, and the comparators' thresholds are searched.
    Searching(TripSearch),
    /// The low sides conduct for so many more instants.
    Charging(u32),
    /// Pulses show whether the stated phase at the index is the motor's.
    Checking(OffsetCheck),
}

/// State of the current interrupt for a brushless or a brushed motor: a program only has the code for its
/// kind.
pub struct CurrentIsr<const BRUSHLESS: bool> {
    controller: CurrentController,
    current_loop: &'static CurrentLoop,
    /// Instants per period of the servo.
    updates: u32,
    /// The instant within the servo's period: 0 at its beginning.
    instant: u32,
    /// The instant at which a code becomes the reference.
    due: u32,
    /// Clock counts of one and a half PWM periods, after which an instant is late; and the clock at the last
    /// instant.
    latest: u32,
    last: u32,
    start_up: StartUp,
    heating: Heating,
    alignment: Option<Alignment>,
    /// The code's torque that the current follows, as [`DacCode::offset`].
    reference: i16,
}

impl<const BRUSHLESS: bool> CurrentIsr<BRUSHLESS> {
    /// Before the first instant, which is one PWM period after the counter's start.
    pub fn new(
        current_loop: &'static CurrentLoop,
        timing: OutputTiming,
        encoder: EncoderSetup,
    ) -> Self {
        #[cfg(feature = "magnetic")]
        chip::pace(encoder);
        #[cfg(not(feature = "magnetic"))]
        let _ = encoder;
        let mut isr = Self {
            controller: CurrentController::new(current_loop),
            current_loop,
            updates: current_loop.updates().into(),
            instant: 1 % u32::from(current_loop.updates()),
            due: current_loop.instants_in(timing),
            latest: 3 * u32::from(current_loop.timer_counts()),
            last: 0,
            start_up: StartUp::Waiting,
            heating: current_loop.heating(),
            alignment: None,
            reference: 0,
        };
        isr.know_phase();
        isr
    }

    /// An absolute encoder has its index at the angle zero, without a turn of the handle.
    #[cfg(feature = "magnetic")]
    fn know_phase(&mut self) {
        if BRUSHLESS {
            // The only index is where it was.
            let _ = self.controller.observe_index(RawCount::from(0_u32));
            latest::keep_index(self.controller.index_offset());
        }
    }

    #[cfg(not(feature = "magnetic"))]
    const fn know_phase(&mut self) {}

    /// One instant.
    #[inline(always)]
    pub fn run(&mut self, encoder: EncoderSetup) {
        // Sampling.
        #[cfg(feature = "magnetic")]
        let position = chip::position(encoder);
        #[cfg(not(feature = "magnetic"))]
        let (position, _) = (quadrature::captured(), encoder);
        let now = now();
        let begins = self.instant == 0;
        if begins {
            encoder::begin_period(position, now);
        }
        let since_last = now.wrapping_sub(core::mem::replace(&mut self.last, now));
        pwm::acknowledge();
        let currents = sense::currents();
        let (bus, temperature) = sense::bus_and_temperature();
        let sample = Sample { currents, bus, temperature, position };
        if self.instant == self.due {
            self.reference = reference();
        }
        // Control and output.
        if STATE.load(Ordering::Relaxed) == State::On as u8 {
            self.drive(&sample, since_last);
        } else {
            cold_path();
            self.otherwise(&sample, since_last);
        }
        #[cfg(not(feature = "magnetic"))]
        if BRUSHLESS && quadrature::has_index() {
            cold_path();
            self.take_index();
        }
        // Bookkeeping: the host, and the servo, both below this.
        if begins {
            let current = self.controller.current();
            latest::keep(&sample, current);
            if let Some(step) = self.heating.observe(current, self.reference) {
                cold_path();
                tell_heat(step);
            }
        }
        self.instant += 1;
        if self.instant == self.updates {
            self.instant = 0;
        }
        if begins {
            NVIC::pend(interrupt::TIM6_DAC);
        }
    }

    #[inline(always)]
    fn drive(&mut self, sample: &Sample, since_last: u32) {
        if pwm::broke() {
            cold_path();
            return stop(self.controller.over_current(sample));
        }
        if since_last > self.latest {
            cold_path();
            return stop(self.late(since_last));
        }
        match self.controller.step_of::<BRUSHLESS>(sample, self.reference) {
            Ok(duties) => pwm::set(self.current_loop, duties),
            Err(fault) => return stop(fault),
        }
        if pwm::updated() {
            cold_path();
            stop(self.late(now().wrapping_sub(self.last)));
        }
    }

    /// Handles an index that came since the last instant's sample, or just after this instant's sample.
    #[cfg(not(feature = "magnetic"))]
    #[cold]
    #[inline(never)]
    fn take_index(&mut self) {
        let observed = self.controller.observe_index(quadrature::take_index());
        latest::keep_index(self.controller.index_offset());
        if let Err(fault) = observed {
            stop(fault);
        }
    }

    /// The fault of an instant that began or ended `late` clock counts after the beginning of the last.
    #[cold]
    const fn late(&self, late: u32) -> PowerFault {
        PowerFault::CurrentInterruptLate { late, allowed: self.latest }
    }

    /// All instants except those in which the servo drives the motor.
    #[cold]
    #[inline(never)]
    fn otherwise(&mut self, sample: &Sample, since_last: u32) {
        let state = STATE.load(Ordering::Relaxed);
        if BRUSHLESS && state == State::Aligning as u8 {
            return self.align(sample, since_last);
        }
        let is_requested =
            state == State::Starting as u8 || BRUSHLESS && state == State::StartingAlignment as u8;
        if !is_requested {
            self.start_up = StartUp::Waiting;
        }
        match &mut self.start_up {
            StartUp::Charging(left) => {
                let left = *left;
                return self.charge(sample, left, state);
            }
            StartUp::Checking(check) if BRUSHLESS => {
                if pwm::broke() {
                    return stop(self.controller.over_current(sample));
                }
                return match self.controller.check_offset(sample, check) {
                    Ok(Some(duties)) => pwm::set(self.current_loop, duties),
                    Ok(None) => {
                        self.start(state).map_or_else(stop, |state| self.finish_start(state))
                    }
                    Err(fault) => stop(fault),
                };
            }
            _ => {}
        }
        // With the gates low, measures the offsets of the amplifiers. The first duties of the low sides are set
        // in time for the gates that are switched on.
        self.controller.measure_offset(sample);
        pwm::low_sides_only(self.current_loop);
        if is_requested && let Err(fault) = self.prepare_to_start(state) {
            stop(fault);
        }
    }

    /// An instant between a request and the low sides, with the gates low.
    fn prepare_to_start(&mut self, state: u8) -> Result<(), PowerFault> {
        if let StartUp::Searching(search) = &mut self.start_up {
            let found = search.step(over_current::tripped())?;
            over_current::search(search.threshold());
            if let Some(trips) = found {
                over_current::set(self.current_loop, trips);
                self.start_up = StartUp::Charging(self.current_loop.charging_instants());
                pwm::on();
            }
            return Ok(());
        }
        // Refusals come before anything is switched.
        self.start(state)?;
        let search = TripSearch::new(self.current_loop.trip_range());
        over_current::search(search.threshold());
        self.start_up = StartUp::Searching(search);
        Ok(())
    }

    /// Prepares the controller for the requested state.
    fn start(&mut self, state: u8) -> Result<State, PowerFault> {
        if BRUSHLESS && state == State::StartingAlignment as u8 {
            self.alignment = Some(self.controller.start_alignment()?);
            return Ok(State::Aligning);
        }
        self.controller.start().map(|()| State::On)
    }

    /// An instant in which the low sides charge the supplies of the high sides' gates.
    fn charge(&mut self, sample: &Sample, left: u32, state: u8) {
        if pwm::broke() {
            return stop(self.controller.over_current(sample));
        }
        let charged = self.controller.charge(sample);
        self.start_up = StartUp::Charging(left.saturating_sub(1));
        if left > 0 {
            return charged.unwrap_or_else(stop);
        }
        let started = match charged.and_then(|()| self.start(state)) {
            Ok(started) => started,
            Err(fault) => return stop(fault),
        };
        let check = match started {
            State::On if BRUSHLESS => self.controller.start_offset_check(),
            _ => None,
        };
        let Some(check) = check else { return self.finish_start(started) };
        pwm::set(self.current_loop, self.current_loop.no_voltage());
        self.start_up = StartUp::Checking(check);
    }

    /// The next instant is the first of the requested state.
    fn finish_start(&mut self, state: State) {
        pwm::set(self.current_loop, self.current_loop.no_voltage());
        self.start_up = StartUp::Waiting;
        STATE.store(state as u8, Ordering::Relaxed);
    }

    /// An instant of an alignment.
    fn align(&mut self, sample: &Sample, since_last: u32) {
        if pwm::broke() {
            return stop(self.controller.over_current(sample));
        }
        if since_last > self.latest {
            return stop(self.late(since_last));
        }
        let Some(alignment) = &mut self.alignment else { return off() };
        match self.controller.align(sample, alignment) {
            Ok(AlignmentStep::Turning(duties)) => {
                pwm::set(self.current_loop, duties);
                if pwm::updated() {
                    stop(self.late(now().wrapping_sub(self.last)));
                }
            }
            Ok(AlignmentStep::Ended(result)) => {
                self.know_phase();
                latest::keep_index(self.controller.index_offset());
                match result {
                    Ok(_) => off(),
                    Err(error) => stop(PowerFault::Alignment(error)),
                }
            }
            Err(fault) => stop(fault),
        }
    }
}

/// The torque of the servo's last code.
#[inline(always)]
fn reference() -> i16 {
    DacCode::from_low_bits(WAITING.load(Ordering::Relaxed)).offset()
}

/// Turns the gates off, and passes the fault to the servo.
#[cold]
#[inline(never)]
fn stop(fault: PowerFault) {
    off();
    tell(Fault::Power(fault));
}
