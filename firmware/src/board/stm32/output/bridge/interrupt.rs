//! One instant of the current loop.

use core::hint::cold_path;
use core::sync::atomic::Ordering;

use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;

use super::{STATE, State, WAITING, off, pace, pwm, sense, tell};
use crate::current::{CurrentController, CurrentLoop, PowerFault, Sample};
use crate::dac::DacCode;
use crate::output_timing::OutputTiming;

/// State of the current interrupt.
pub struct CurrentIsr {
    controller: CurrentController,
    current_loop: &'static CurrentLoop,
    /// Instants in a period of the servo.
    updates: u32,
    /// The instant of the servo's period: 0 where one begins.
    instant: u32,
    /// The instant at which a code becomes the reference.
    due: u32,
    /// The code's torque that the current follows, as [`DacCode::offset`].
    reference: i16,
}

impl CurrentIsr {
    /// Before the first instant, which is one PWM period after the counter's start.
    pub fn new(current_loop: &'static CurrentLoop, timing: OutputTiming) -> Self {
        Self {
            controller: CurrentController::new(current_loop),
            current_loop,
            updates: current_loop.updates().into(),
            instant: 1 % u32::from(current_loop.updates()),
            due: current_loop.instants_in(timing),
            reference: 0,
        }
    }

    /// One instant.
    #[inline(always)]
    pub fn run(&mut self) {
        // Sampling.
        let position = pace::captured();
        let begins = self.instant == 0;
        if begins {
            pace::begin_period(position);
        }
        pwm::acknowledge();
        let currents = sense::currents();
        let (bus, temperature) = sense::bus_and_temperature();
        let sample = Sample { currents, bus, temperature, position };
        if self.instant == self.due {
            self.reference = reference();
        }
        // Control and output.
        if STATE.load(Ordering::Relaxed) == State::On as u8 {
            self.drive(&sample);
        } else {
            cold_path();
            self.idle(&sample);
        }
        // Bookkeeping: the servo, below this.
        self.instant += 1;
        if self.instant == self.updates {
            self.instant = 0;
        }
        if begins {
            NVIC::pend(interrupt::TIM6_DAC);
        }
    }

    #[inline(always)]
    fn drive(&mut self, sample: &Sample) {
        if pwm::broke() {
            cold_path();
            return stop(self.controller.over_current(sample));
        }
        match self.controller.step(sample, self.reference) {
            Ok(duties) => pwm::set(self.current_loop, duties),
            Err(fault) => return stop(fault),
        }
        if pwm::updated() {
            cold_path();
            let allowed = 2 * u32::from(self.current_loop.timer_counts());
            stop(PowerFault::CurrentInterruptLate {
                late: pwm::counts_since_update(allowed),
                allowed,
            });
        }
    }

    /// With the gates low: the offsets of the amplifiers, and the beginning where it is wanted.
    #[cold]
    #[inline(never)]
    fn idle(&mut self, sample: &Sample) {
        self.controller.measure_offset(sample);
        pwm::set(self.current_loop, self.current_loop.no_voltage());
        if STATE.load(Ordering::Relaxed) != State::Starting as u8 {
            return;
        }
        match self.controller.start() {
            Ok(()) => {
                STATE.store(State::On as u8, Ordering::Relaxed);
                pwm::on();
            }
            Err(fault) => stop(fault),
        }
    }
}

/// The torque of the code that the servo gave last.
#[inline(always)]
fn reference() -> i16 {
    DacCode::from_low_bits(WAITING.load(Ordering::Relaxed)).offset()
}

/// Takes the gates away, and tells the servo why.
#[cold]
#[inline(never)]
fn stop(fault: PowerFault) {
    off();
    tell(fault);
}
