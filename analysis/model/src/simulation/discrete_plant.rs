//! The discrete-time plant: a [`Plant`] over one tick, with the servo's period and latency.

use haptic_servo::scene::Latency;
use nalgebra::{DMatrix, DVector};

use super::error::SimulationError;
use super::method::{Method, repeated, rotation, step};
use super::plant::{INPUTS, Input, Plant};

/// How a plant is discretised over a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretization {
    /// The method.
    pub method: Method,
    /// Steps a tick, at least one.
    pub substeps: u32,
    /// Period of the servo in s.
    pub period: f64,
    /// Whole ticks from the sample to the torque that follows from it.
    pub whole: usize,
    /// Further time in s, less than the period.
    pub latency: f64,
    /// Age in s of a reading: an amplifier's updates are that much later than those of a tick.
    pub age: f64,
}

impl Discretization {
    /// The exact method without latency, over a period in s.
    pub fn exact(period: f64) -> Self {
        Self { method: Method::Exact, substeps: 1, period, whole: 0, latency: 0.0, age: 0.0 }
    }

    /// The same with the times of a scene from a reading to its torque, and a further time in s.
    pub fn delayed(self, times: &Latency, further: f64) -> Self {
        // A remainder that comes from rounding alone is not a part of a tick.
        const ROUNDING: f64 = 1e-12;
        let delay = times.torque_delay().middle() + further;
        let ticks = delay / self.period;
        let whole = (ticks + ROUNDING).floor();
        let part = (delay - whole * self.period).max(0.0);
        let latency = if ticks - whole > ROUNDING { part } else { 0.0 };
        Self { whole: whole as usize, latency, age: times.encoder.age.middle(), ..self }
    }

    /// The parts of a tick, before and after the new torque.
    pub(super) fn pieces(&self, plant: &Plant) -> [Vec<Pieces>; 2] {
        let parts = [self.latency, self.period - self.latency];
        let steps =
            |length: f64| (f64::from(self.substeps) * length / self.period).ceil().max(1.0) as u32;
        let piece = |count, length, since| Pieces { count, length, steps: steps(length), since };
        let Some(actuator) = plant.sampled() else {
            return parts.map(|length| vec![piece(1, length, 0.0)]);
        };
        // A tick begins with a reading, which is that much older than an update.
        let (between, first) = (actuator.between(), actuator.after_update(self.age));
        let whole = |length: f64| piece(actuator.in_time(length), between, 0.0);
        if first == 0.0 {
            return parts.map(|length| vec![whole(length)]);
        }
        let rest = between - first;
        [
            vec![piece(1, first, rest), whole(parts[0] - first)],
            vec![whole(parts[1] - rest), piece(1, rest, 0.0)],
        ]
    }

    /// An error if a torque begins between two updates of the amplifier.
    pub(super) fn at_updates(&self, plant: &Plant) -> Result<(), SimulationError> {
        match plant.sampled() {
            Some(actuator) if !actuator.is_whole(self.latency - self.age) => {
                let (delay, between) = (self.latency, actuator.between());
                Err(SimulationError::BetweenUpdates { delay, between })
            }
            _ => Ok(()),
        }
    }
}

/// Pieces of equal length of a part of a tick; the motor's input is held over each. There is one piece,
/// unless the amplifier is updated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pieces {
    /// How many there are.
    pub count: u32,
    /// Length of each in s.
    pub length: f64,
    /// Steps of the method over each, at least one.
    pub steps: u32,
    /// Time in s since the last update of the amplifier at their beginning.
    pub since: f64,
}

impl Pieces {
    /// Over one piece, for states and inputs; the motor's input is the command.
    pub(super) fn once(&self, plant: &Plant, method: Method, omega: f64) -> DMatrix<f64> {
        let step = step(plant, method, omega, self.length / f64::from(self.steps));
        plant.commanded(repeated(&step, self.steps), self.since)
    }
}

/// `x(k+1) = transition x(k) + previous u(k-n-1) + motor u(k-n) + hand w(k) + sine (s, c)(k)`, with
/// `n = whole`.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscretePlant {
    /// From the state at the tick's start.
    pub transition: DMatrix<f64>,
    /// From the motor torque before the next one, which lasts for the latency; zero without latency.
    pub previous: DVector<f64>,
    /// From the motor torque that the sample of `whole` ticks ago leads to.
    pub motor: DVector<f64>,
    /// Whole ticks from a sample to its torque.
    pub whole: usize,
    /// The state that the servo reads.
    pub measured: usize,
    /// From the hand's torque held over the tick.
    pub hand: DVector<f64>,
    /// From the hand's sine torque at the tick's start and from its cosine.
    pub sine: [DVector<f64>; 2],
}

impl DiscretePlant {
    /// Takes the plant through a tick; `omega` in rad/s is that of the hand's sine torque.
    pub fn new(plant: &Plant, discretization: &Discretization, omega: f64) -> Self {
        let through = |pieces: Vec<Pieces>| {
            let size = plant.order() + INPUTS + 2;
            pieces.iter().fold(DMatrix::identity(size, size), |through, piece| {
                repeated(&piece.once(plant, discretization.method, omega), piece.count) * through
            })
        };
        Self::over(plant, discretization.pieces(plant).map(through), discretization, omega)
    }

    /// From what the parts before and after the new torque make of states and inputs.
    pub(super) fn over(
        plant: &Plant,
        [before, after]: [DMatrix<f64>; 2],
        discretization: &Discretization,
        omega: f64,
    ) -> Self {
        let n = plant.order();
        let part = |whole: &DMatrix<f64>| whole.view((0, 0), (n, n)).into_owned();
        let column = |whole: &DMatrix<f64>, index: usize| {
            whole.view((0, n + index), (n, 1)).column(0).into_owned()
        };
        let (motor, hand, sine) = (Input::Motor as usize, Input::Hand as usize, INPUTS);
        let late = part(&after);
        let turned = rotation(omega * discretization.latency);
        let oscillator = |i: usize| {
            let later =
                column(&after, sine) * turned[(0, i)] + column(&after, sine + 1) * turned[(1, i)];
            &late * column(&before, sine + i) + later
        };
        Self {
            transition: &late * part(&before),
            previous: &late * column(&before, motor),
            motor: column(&after, motor),
            whole: discretization.whole,
            measured: plant.measured(),
            hand: &late * column(&before, hand) + column(&after, hand),
            sine: [oscillator(0), oscillator(1)],
        }
    }

    /// The same, where its numbers are finite.
    ///
    /// # Errors
    /// Where the machine is too fast for its motion over a period to be computed.
    pub fn checked(
        plant: &Plant,
        discretization: &Discretization,
        omega: f64,
    ) -> Result<Self, SimulationError> {
        discretization.at_updates(plant)?;
        Self::new(plant, discretization, omega).finite(plant, discretization.period)
    }

    /// The same, where its numbers are finite.
    ///
    /// # Errors
    /// Where the machine is too fast for its motion over this period to be computed.
    pub(super) fn finite(self, plant: &Plant, period: f64) -> Result<Self, SimulationError> {
        let tick = self;
        let inputs = [&tick.previous, &tick.motor, &tick.hand, &tick.sine[0], &tick.sine[1]];
        let mut entries = inputs.iter().flat_map(|input| input.iter()).chain(&tick.transition);
        if entries.all(|entry| entry.is_finite()) {
            Ok(tick)
        } else {
            let rate = plant.rates().amax();
            Err(SimulationError::TooFast { rate, period })
        }
    }

    /// The state after a tick from `state` with these torques in N m held over it; no torque of an earlier
    /// tick remains, and the hand has no sine torque.
    pub fn end(&self, state: &DVector<f64>, motor: f64, hand: f64) -> DVector<f64> {
        &self.transition * state + &self.motor * motor + &self.hand * hand
    }

    /// Whether a torque begins within a tick.
    pub fn is_late(&self) -> bool {
        self.previous.iter().any(|&effect| effect != 0.0)
    }

    /// Number of torques of earlier ticks that have not acted yet.
    pub fn pending(&self) -> usize {
        self.whole + usize::from(self.is_late())
    }

    /// Transition of the plant's states with the torques that have not acted yet behind them, the newest
    /// first, and the effect on both of the torque of this tick's sample.
    pub fn with_pending(&self) -> (DMatrix<f64>, DVector<f64>) {
        let (n, pending) = (self.transition.nrows(), self.pending());
        let size = n + pending;
        let mut transition = self.transition.clone().resize(size, size, 0.0);
        let mut motor = DVector::zeros(size);
        for (age, effect) in [(self.whole, &self.motor), (self.whole + 1, &self.previous)] {
            if age == 0 {
                motor.rows_mut(0, n).copy_from(effect);
            } else if age <= pending {
                transition.view_mut((0, n + age - 1), (n, 1)).copy_from(effect);
            }
        }
        if pending > 0 {
            motor[n] = 1.0;
        }
        for row in n + 1..size {
            transition[(row, row - 1)] = 1.0;
        }
        (transition, motor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_servo::scene::Device;

    #[test]
    fn latency_splits_the_tick_and_nothing_else() {
        let plant = Plant::rigid(Device { inertia: 2e-4, damping: 0.02, passivity: None });
        let discretization =
            |delay| Discretization::exact(1e-3).delayed(&Latency::delayed(delay), 0.0);
        let [prompt, late] =
            [0.0, 4e-4].map(|latency| DiscretePlant::new(&plant, &discretization(latency), 900.0));
        assert!(!prompt.is_late() && late.is_late());
        let near = |a: &DVector<f64>, b: &DVector<f64>| assert!((a - b).amax() < 1e-12 * b.amax());
        assert!((&prompt.transition - &late.transition).amax() < 1e-15);
        near(&(&late.previous + &late.motor), &prompt.motor);
        near(&late.hand, &prompt.hand);
        near(&late.sine[0], &prompt.sine[0]);
        near(&late.sine[1], &prompt.sine[1]);
    }
}
