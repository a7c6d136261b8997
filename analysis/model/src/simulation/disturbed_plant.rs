//! Coulomb friction and cogging on the motor's mass: it slides against a constant torque, or it sticks.
//!
//! In each of the two modes the plant is linear but for the cogging, and steps by the method's matrices; the
//! time of the change has to be found. A step at whose end the mode no longer holds is halved until the change
//! lies in a piece that is too short to matter. Cogging acts as an impulse of half its step at either end of
//! each: over a step that is short against its oscillation this is of the second order, and keeps its energy.

use nalgebra::{DMatrix, DVector};

use super::discrete_plant::{Discretization, Pieces};
use super::method::step;
use super::plant::{INPUTS, Input, Plant};
use crate::disturbance::Disturbance;

/// Halvings of a step: a change is placed to a millionth of it.
const HALVINGS: usize = 20;
/// Least steps a tick. A change and back within one step would not be seen.
const LEAST_STEPS: u32 = 8;
/// Changes that are placed within one step. A mass that trembles at the border between the modes changes at
/// every check; beyond this number it is checked once a step.
const CHANGES: u32 = 16;
/// Largest angle in rad by which the mass oscillates in its cogging within a step.
const LONGEST_STEP: f64 = 0.02;

/// How the motor's mass moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// It does not move.
    Stuck,
    /// In the direction of this sign.
    Slides(f64),
}

/// A plant with friction and cogging, one tick at a time.
#[derive(Clone, Debug)]
pub struct DisturbedPlant {
    plant: Plant,
    disturbance: Disturbance,
    parts: Vec<Part>,
}

/// The states of the plant, with the inputs behind them, and how its motor's mass moves.
#[derive(Clone, Debug)]
pub struct DisturbedState {
    states: DVector<f64>,
    mode: Mode,
}

impl DisturbedState {
    /// The states of the plant, and its inputs behind them.
    pub fn states(&self) -> &DVector<f64> {
        &self.states
    }
}

/// The inputs of a tick.
#[derive(Clone, Copy, Debug)]
pub struct TickInputs {
    /// Torque of the hand in N m, or the speed of its grip in rad/s, held over the tick.
    pub hand: f64,
    /// Sine torque of the hand in N m at the tick's start, and its cosine.
    pub sine: [f64; 2],
    /// Motor torques in N m before and after the latency.
    pub motor: [f64; 2],
}

/// A part of the tick over which the commanded torque is held.
#[derive(Clone, Debug)]
struct Part {
    /// Number of pieces, over each of which the motor's input is held.
    pieces: u32,
    /// Steps in each piece.
    steps: u32,
    /// Length in s of a step.
    length: f64,
    /// Time in s since the amplifier's last update at its beginning.
    since: f64,
    /// A step and its halves, for a motor's mass that slides.
    slides: Vec<DMatrix<f64>>,
    /// The same for the stuck mass.
    stuck: Vec<DMatrix<f64>>,
    /// Whether it comes before the torque of this tick's sample.
    early: bool,
}

/// A step that was made.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Length in s.
    pub length: f64,
    /// States with the inputs behind them, at its start and at its end.
    pub from: &'a DVector<f64>,
    /// See `from`.
    pub to: &'a DVector<f64>,
    /// Torque in N m that the motor was commanded.
    pub command: f64,
}

/// Takes the length in s of a step that was made, and the states at its start and at its end.
type OnStep<'a> = dyn FnMut(f64, &DVector<f64>, &DVector<f64>) + 'a;

impl DisturbedPlant {
    /// A plant with friction and cogging at its motor; `omega` in rad/s is that of the hand's sine torque.
    pub fn new(
        plant: &Plant,
        disturbance: Disturbance,
        discretization: &Discretization,
        omega: f64,
    ) -> Self {
        let stuck = plant.clone().with_motor_stuck();
        let halves = |plant: &Plant, h: f64| -> Vec<DMatrix<f64>> {
            let length = |halving: usize| h * 0.5_f64.powi(halving as i32);
            let one = |halving| step(plant, discretization.method, omega, length(halving));
            (0..=HALVINGS).map(one).collect()
        };
        let oscillation = disturbance.cogging.rate(plant.motor_inertia());
        let part = |(early, Pieces { count, length, steps, since }): (bool, Pieces)| {
            let fine = (oscillation * length / LONGEST_STEP).ceil() as u32;
            let steps = steps.max(LEAST_STEPS).max(fine);
            let length = length / f64::from(steps);
            let [slides, stuck] = [plant, &stuck].map(|plant| halves(plant, length));
            Part { pieces: count, steps, length, since, slides, stuck, early }
        };
        let [before, after] = discretization.pieces(plant);
        let before = before.into_iter().map(|pieces| (true, pieces));
        let parts = before.chain(after.into_iter().map(|pieces| (false, pieces)));
        let is_some = |piece: &Pieces| piece.count > 0 && piece.length > 0.0;
        let parts = parts.filter(|(_, pieces)| is_some(pieces)).map(part).collect();
        Self { plant: plant.clone(), disturbance, parts }
    }

    /// The state from which it goes on from these states of the plant.
    pub fn at(&self, states: &DVector<f64>) -> DisturbedState {
        let n = self.plant.order();
        let mut all = DVector::zeros(n + INPUTS + 2);
        all.rows_mut(0, n).copy_from(states);
        let mode = match states[self.plant.motor_velocity()] {
            0.0 => Mode::Stuck,
            velocity => Mode::Slides(velocity.signum()),
        };
        DisturbedState { states: all, mode }
    }

    /// One tick; `after` is called with each step of it.
    pub fn tick(
        &self,
        state: &mut DisturbedState,
        inputs: &TickInputs,
        mut after: impl FnMut(&Step<'_>),
    ) {
        let n = self.plant.order();
        let [sine, cosine] = inputs.sine;
        state.states[n + Input::Hand as usize] = inputs.hand;
        state.states[n + INPUTS] = sine;
        state.states[n + INPUTS + 1] = cosine;
        let [before, later] = inputs.motor;
        for part in &self.parts {
            let command = if part.early { before } else { later };
            for _ in 0..part.pieces {
                let input = self.plant.motor_input(command, &state.states, part.since);
                state.states[n + Input::Motor as usize] = input;
                self.settle(state);
                for _ in 0..part.steps {
                    let mut changes = 0;
                    let mut made = |length: f64, from: &DVector<f64>, to: &DVector<f64>| {
                        after(&Step { length, from, to, command });
                    };
                    self.go(state, part, 0, &mut changes, &mut made);
                }
            }
        }
    }

    /// One step, halved around a change of mode.
    fn go(
        &self,
        state: &mut DisturbedState,
        part: &Part,
        halving: usize,
        changes: &mut u32,
        made: &mut OnStep<'_>,
    ) {
        let length = part.length * 0.5_f64.powi(halving as i32);
        let mut next = self.stepped(state, part, halving, length);
        if !self.holds(state.mode, &next) {
            if halving < HALVINGS && *changes < CHANGES {
                self.go(state, part, halving + 1, changes, made);
                return self.go(state, part, halving + 1, changes, made);
            }
            *changes += 1;
            if let Mode::Slides(_) = state.mode {
                next[self.plant.motor_velocity()] = 0.0;
                state.mode = Mode::Stuck;
            }
            made(length, &state.states, &next);
            state.states = next;
            return self.settle(state);
        }
        made(length, &state.states, &next);
        state.states = next;
    }

    /// The states after a step in the present mode.
    fn stepped(
        &self,
        state: &DisturbedState,
        part: &Part,
        halving: usize,
        length: f64,
    ) -> DVector<f64> {
        match state.mode {
            Mode::Stuck => &part.stuck[halving] * &state.states,
            Mode::Slides(_) if self.disturbance.cogging.is_none() => {
                &part.slides[halving] * &state.states
            }
            Mode::Slides(_) => {
                let mut start = state.states.clone();
                self.kick(&mut start, length);
                let mut end = &part.slides[halving] * start;
                self.kick(&mut end, length);
                end
            }
        }
    }

    /// The impulse of the cogging over half a step of this length in s.
    fn kick(&self, states: &mut DVector<f64>, length: f64) {
        let torque = self.cogging(states);
        states[self.plant.motor_velocity()] += 0.5 * length * torque / self.plant.motor_inertia();
    }

    fn cogging(&self, states: &DVector<f64>) -> f64 {
        self.disturbance.cogging.at(states[self.plant.motor_position()])
    }

    fn holds(&self, mode: Mode, states: &DVector<f64>) -> bool {
        match mode {
            Mode::Stuck => self.push(states).abs() <= self.disturbance.friction,
            Mode::Slides(_) if self.disturbance.friction == 0.0 => true,
            Mode::Slides(sign) => sign * states[self.plant.motor_velocity()] >= 0.0,
        }
    }

    /// Lets go of a mass that is pushed harder than its friction, and sets the friction's torque.
    fn settle(&self, state: &mut DisturbedState) {
        let DisturbedState { states, mode } = state;
        let push = self.push(states);
        if *mode == Mode::Stuck && push.abs() > self.disturbance.friction {
            *mode = Mode::Slides(push.signum());
        }
        let torque = match *mode {
            Mode::Stuck => 0.0,
            Mode::Slides(sign) => -sign * self.disturbance.friction,
        };
        let n = self.plant.order();
        states[n + Input::Friction as usize] = torque;
    }

    /// Torque in N m of everything but friction on the motor's mass.
    fn push(&self, states: &DVector<f64>) -> f64 {
        let n = self.plant.order();
        let rates = self.plant.rates().row(self.plant.motor_velocity()).transpose();
        let rates = rates.dot(&states.rows(0, n));
        let inputs = self.plant.inputs().row(self.plant.motor_velocity());
        let [motor, hand] = [Input::Motor, Input::Hand].map(|input| input as usize);
        // The sine is another torque of the hand.
        let hands = inputs[hand] * (states[n + hand] + states[n + INPUTS]);
        let held = rates + inputs[motor] * states[n + motor] + hands;
        let push = self.plant.motor_inertia() * held;
        if self.disturbance.cogging.is_none() { push } else { push + self.cogging(states) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disturbance::sine;
    use haptic_servo::scene::Device;

    /// A mass of 0.5 kg m^2 without damping, in ticks of 0.25 s.
    struct Mass {
        plant: DisturbedPlant,
        state: DisturbedState,
    }

    impl Mass {
        fn new(disturbance: Disturbance, velocity: f64) -> Self {
            let plant = Plant::rigid(Device { inertia: 0.5, damping: 0.0, passivity: None });
            let start = plant.state_at(0.0, velocity);
            let discretization = Discretization::exact(0.25);
            let plant = DisturbedPlant::new(&plant, disturbance, &discretization, 0.0);
            Self { state: plant.at(&start), plant }
        }

        /// Position and velocity after a tick with this torque.
        fn after(&mut self, torque: f64) -> [f64; 2] {
            let inputs = TickInputs { hand: 0.0, sine: [0.0; 2], motor: [0.0, torque] };
            self.plant.tick(&mut self.state, &inputs, |_| ());
            [self.state.states()[0], self.state.states()[1]]
        }
    }

    fn rubbing(friction: f64) -> Disturbance {
        Disturbance { friction, ..Disturbance::default() }
    }

    #[test]
    fn a_sliding_mass_comes_to_rest_where_its_energy_is_used_up() {
        let mut mass = Mass::new(rubbing(0.3), 2.0);
        let [position, velocity] = (0..40).map(|_| mass.after(0.0)).last().unwrap();
        let way = 0.5 * 0.5 * 4.0 / 0.3;
        assert!((position - way).abs() < 1e-9, "{position}");
        assert_eq!(velocity, 0.0);
    }

    #[test]
    fn a_stuck_mass_gives_way_only_to_more_than_its_friction() {
        let mut mass = Mass::new(rubbing(0.3), 0.0);
        assert_eq!(mass.after(0.3)[1], 0.0);
        assert!((mass.after(-0.4)[1] + 0.1 / 0.5 * 0.25).abs() < 1e-12);
    }

    /// A mass in its cogging is a pendulum, whose period the arithmetic-geometric mean has.
    #[test]
    fn a_mass_swings_in_its_cogging_as_a_pendulum_does() {
        let cogging = sine(0.2, 7.0);
        let disturbance = Disturbance { cogging, ..Disturbance::default() };
        // To 2 rad of the cogging's period, from the middle.
        let largest: f64 = 2.0;
        let rate = (cogging.slope() / 0.5).sqrt();
        let velocity = 2.0 * rate * (0.5 * largest).sin() / cogging.highest();
        let (mut a, mut b) = (1.0, (0.5 * largest).cos());
        for _ in 0..8 {
            (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
        }
        let period = std::f64::consts::TAU / (rate * a);
        let mut mass = Mass::new(disturbance, velocity);
        let (mut last, mut ends) = ([0.0, velocity], Vec::new());
        for tick in 1..400 {
            let next = mass.after(0.0);
            if last[0] < 0.0 && next[0] >= 0.0 {
                ends.push(0.25 * (f64::from(tick) - next[0] / (next[0] - last[0])));
            }
            assert!(next[0].abs() < largest / cogging.highest() * 1.001, "{next:?}");
            last = next;
        }
        let (first, end) = (ends[0], ends[ends.len() - 1]);
        let found = (end - first) / (ends.len() - 1) as f64;
        assert!((found / period - 1.0).abs() < 5e-4, "{found} {period}");
    }

    /// It rests where cogging and torque together are no more than its friction; the way there takes up the
    /// rest of its energy.
    #[test]
    fn a_mass_sticks_on_the_flank_of_its_cogging() {
        let cogging = sine(0.2, 3.0);
        let mut mass = Mass::new(Disturbance { friction: 0.15, cogging }, 0.5);
        let [position, velocity] = (0..40).map(|_| mass.after(0.0)).last().unwrap();
        let spent = 0.15 * position + cogging.energy(position);
        assert!(velocity == 0.0 && (spent - 0.0625).abs() < 2e-5, "{position} {spent}");
        assert!(cogging.at(position).abs() <= 0.15, "{position}");
        // More than friction and cogging together move it, and less does not.
        let edge = 0.15 - cogging.at(position);
        assert_eq!(mass.after(0.999 * edge)[1], 0.0);
        assert!(mass.after(1.001 * edge)[1] > 0.0);
    }
}
