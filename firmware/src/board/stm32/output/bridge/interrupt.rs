//! One instant of the current loop.

use core::hint::cold_path;
use core::sync::atomic::Ordering;

use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;

use super::{STATE, State, WAITING, index, latest, off, over_current, pace, pwm, sense, tell};
use crate::board::stm32::output::periods::now;
use crate::current::{
    Alignment, AlignmentStep, CurrentController, CurrentLoop, PowerFault, Sample,
};
use crate::dac::DacCode;
use crate::output_timing::OutputTiming;

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
    /// The running alignment.
    alignment: Option<Alignment>,
    /// The code's torque that the current follows, as [`DacCode::offset`].
    reference: i16,
}

impl<const BRUSHLESS: bool> CurrentIsr<BRUSHLESS> {
    /// Before the first instant, which is one PWM period after the counter's start.
    pub fn new(current_loop: &'static CurrentLoop, timing: OutputTiming) -> Self {
        Self {
            controller: CurrentController::new(current_loop),
            current_loop,
            updates: current_loop.updates().into(),
            instant: 1 % u32::from(current_loop.updates()),
            due: current_loop.instants_in(timing),
            latest: 3 * u32::from(current_loop.timer_counts()),
            last: 0,
            alignment: None,
            reference: 0,
        }
    }

    /// One instant.
    #[inline(always)]
    pub fn run(&mut self) {
        // Sampling.
        let (position, now) = (pace::captured(), now());
        let begins = self.instant == 0;
        if begins {
            pace::begin_period(position, now);
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
            self.otherwise(&sample);
        }
        if BRUSHLESS && index::has_come() {
            cold_path();
            self.take_index();
        }
        // Bookkeeping: the host, and the servo, both below this.
        if begins {
            latest::keep(&sample, self.controller.current());
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
    #[cold]
    #[inline(never)]
    fn take_index(&mut self) {
        let observed = self.controller.observe_index(index::take());
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
    fn otherwise(&mut self, sample: &Sample) {
        let state = STATE.load(Ordering::Relaxed);
        if BRUSHLESS && state == State::Aligning as u8 {
            return self.align(sample);
        }
        // With the gates low, measures the offsets of the amplifiers.
        self.controller.measure_offset(sample);
        pwm::set(self.current_loop, self.current_loop.no_voltage());
        let started = if state == State::Starting as u8 {
            self.controller.start().map(|()| State::On)
        } else if BRUSHLESS && state == State::StartingAlignment as u8 {
            self.controller.start_alignment().map(|alignment| {
                self.alignment = Some(alignment);
                State::Aligning
            })
        } else {
            return;
        };
        match started {
            Ok(state) => {
                let zero = self.controller.offsets();
                over_current::set(zero, self.current_loop.over_current_counts());
                STATE.store(state as u8, Ordering::Relaxed);
                pwm::on();
            }
            Err(fault) => stop(fault),
        }
    }

    /// An instant of an alignment.
    fn align(&mut self, sample: &Sample) {
        if pwm::broke() {
            return stop(self.controller.over_current(sample));
        }
        let Some(alignment) = &mut self.alignment else { return off() };
        match self.controller.align(sample, alignment) {
            Ok(AlignmentStep::Turning(duties)) => pwm::set(self.current_loop, duties),
            Ok(AlignmentStep::Ended(result)) => {
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
    tell(fault);
}
