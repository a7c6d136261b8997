//! The power stage without its interrupts, for the tests on a board: instant by instant, by polling.
//!
//! The protection is that of the current loop: from [`Load::on`] on, the comparators break TIM1's outputs.

use embassy_stm32::pac;

use super::encoder::quadrature;
use super::{over_current, pwm, sense};
use crate::board::stm32::output::gates::Gate;
use crate::board::stm32::wiring::GATES;
use crate::current::{CurrentLoop, Duties, PowerFault, Sample, TripCodes, TripSearch};

/// The number of polls after which an instant counts as missed: much longer than a period of the modulation.
const PATIENCE: u32 = 100_000;

/// The bridge with a load at its outputs.
pub struct Load {
    current_loop: &'static CurrentLoop,
}

impl Load {
    /// Sets everything up, with TIM1 counting and the gates low.
    pub fn new(current_loop: &'static CurrentLoop) -> Self {
        pwm::prepare(current_loop);
        GATES.connect(current_loop.phases());
        over_current::prepare();
        sense::prepare();
        quadrature::capture_counts();
        pwm::start();
        Self { current_loop }
    }

    /// The sample of the next instant; `None` if the instant is missed.
    pub fn next(&mut self) -> Option<Sample> {
        let came = (0..PATIENCE).any(|_| sense::is_converted());
        came.then(|| {
            pwm::acknowledge();
            let currents = sense::currents();
            let (bus, temperature) = sense::bus_and_temperature();
            Sample { currents, bus, temperature, position: quadrature::captured() }
        })
    }

    /// Finds the codes at which the comparators trip with the gates low. `None` if an instant is missed.
    pub fn trips(&mut self) -> Option<Result<TripCodes, PowerFault>> {
        let mut search = TripSearch::new(self.current_loop.trip_range());
        loop {
            over_current::search(search.threshold());
            self.next()?;
            if let Some(end) = search.step(over_current::tripped()).transpose() {
                return Some(end);
            }
        }
    }

    /// Sets the thresholds of the current loop above these codes, lets the low sides conduct as long as a start
    /// does, and then switches the gates at zero voltage. `None` if an instant is missed.
    pub fn on(&mut self, trips: TripCodes) -> Option<()> {
        pwm::low_sides_only(self.current_loop);
        over_current::set(self.current_loop, trips);
        pwm::on();
        for _ in 0..self.current_loop.charging_instants() {
            self.next()?;
        }
        self.set(self.current_loop.no_voltage());
        Some(())
    }

    /// Has the input of one gate driver high for an instant, of the high or the low side of a phase. Returns which
    /// inputs were high meanwhile, and the sample at its end; `None` if it is missed.
    pub fn pulse(&mut self, phase: usize, side: usize) -> Option<([[bool; 2]; 3], Sample)> {
        let gate = &GATES.0[phase][side];
        gate.drive(true);
        let sample = self.next();
        let high = GATES.0.each_ref().map(|sides| sides.each_ref().map(|gate| !gate.is_low()));
        gate.drive(false);
        Some((high, sample?))
    }

    /// Sets the duties from the next instant on.
    pub fn set(&mut self, duties: Duties) {
        pwm::set(self.current_loop, duties);
    }

    /// Sets all gates low at once.
    pub fn off(&mut self) {
        super::off();
    }

    /// Triggers a break by the program, like that of a comparator.
    pub fn break_now(&mut self) {
        pac::TIM1.egr().write(|w| w.set_bg(0, true));
    }

    /// Whether there was a break.
    pub fn broke(&self) -> bool {
        pwm::broke()
    }

    /// Whether the timer drives the gates.
    pub fn is_on(&self) -> bool {
        pac::TIM1.bdtr().read().moe()
    }

    /// Whether the pins of all six gate driver inputs are low at this moment.
    pub fn are_gates_low(&self) -> bool {
        GATES.0.as_flattened().iter().all(Gate::is_low)
    }
}
