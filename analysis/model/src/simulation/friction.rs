//! Coulomb friction on the motor's mass: it slides against a constant torque, or it sticks.
//!
//! In each of the two modes the plant is linear and steps by the method's matrices; the time of the change
//! has to be found. A step at whose end the mode no longer holds is halved until the change lies in a piece
//! that is too short to matter.

use nalgebra::{DMatrix, DVector};

use super::discrete_plant::{Discretization, Pieces};
use super::method::step;
use super::plant::{INPUTS, Input, Plant};
use super::torque_signal::TorqueSignal;

/// Halvings of a step: a change is placed to a millionth of it.
const HALVINGS: usize = 20;
/// Least steps a tick. A change and back within one step would not be seen.
const LEAST_STEPS: u32 = 8;
/// Changes that are placed within one step. A mass that trembles at the border between the modes changes at
/// every check; beyond this number it is checked once a step.
const CHANGES: u32 = 16;

/// How the motor's mass moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// It does not move.
    Stuck,
    /// In the direction of this sign.
    Slides(f64),
}

/// A plant with Coulomb friction, one tick at a time.
#[derive(Clone, Debug)]
pub struct FrictionPlant {
    plant: Plant,
    friction: f64,
    period: f64,
    parts: Vec<Part>,
    state: DVector<f64>,
    mode: Mode,
}

/// A part of the tick over which the commanded torque is held.
#[derive(Clone, Debug)]
struct Part {
    /// Number of pieces, over each of which the motor's input is held.
    pieces: u32,
    /// Steps in each piece.
    steps: u32,
    /// A step and its halves, for a motor's mass that slides.
    slides: Vec<DMatrix<f64>>,
    /// The same for the stuck mass.
    stuck: Vec<DMatrix<f64>>,
    /// Whether it comes before the torque of this tick's sample.
    early: bool,
}

impl FrictionPlant {
    /// The plant at `state` with a friction of up to `friction` N m.
    pub fn new(
        plant: &Plant,
        friction: f64,
        discretization: &Discretization,
        omega: f64,
        state: &DVector<f64>,
    ) -> Self {
        let stuck = plant.clone().with_motor_stuck();
        let halves = |plant: &Plant, h: f64| -> Vec<DMatrix<f64>> {
            let length = |halving: usize| h * 0.5_f64.powi(halving as i32);
            let one = |halving| step(plant, discretization.method, omega, length(halving));
            (0..=HALVINGS).map(one).collect()
        };
        let part = |(early, Pieces { count, length, steps }): (bool, Pieces)| {
            let steps = steps.max(LEAST_STEPS);
            let h = length / f64::from(steps);
            Part { pieces: count, steps, slides: halves(plant, h), stuck: halves(&stuck, h), early }
        };
        let parts = [true, false].into_iter().zip(discretization.pieces(plant));
        let is_some = |piece: &Pieces| piece.count > 0 && piece.length > 0.0;
        let parts = parts.filter(|(_, pieces)| is_some(pieces)).map(part).collect();
        let n = plant.order();
        let mut all = DVector::zeros(n + INPUTS + 2);
        all.rows_mut(0, n).copy_from(state);
        let mode = match state[plant.motor_velocity()] {
            0.0 => Mode::Stuck,
            velocity => Mode::Slides(velocity.signum()),
        };
        Self {
            plant: plant.clone(),
            friction,
            period: discretization.period,
            parts,
            state: all,
            mode,
        }
    }

    /// The plant's states.
    pub fn state(&self) -> &DVector<f64> {
        &self.state
    }

    /// One tick with the motor torques in N m before and after the latency.
    pub fn tick(&mut self, k: usize, hand_torque: &TorqueSignal, [before, after]: [f64; 2]) {
        let n = self.plant.order();
        let [sine, cosine] = hand_torque.sine(k, self.period);
        self.state[n + Input::Hand as usize] = hand_torque.held(k);
        self.state[n + INPUTS] = sine;
        self.state[n + INPUTS + 1] = cosine;
        for part in std::mem::take(&mut self.parts) {
            let command = if part.early { before } else { after };
            for _ in 0..part.pieces {
                let input = self.plant.motor_input(command, &self.state);
                self.state[n + Input::Motor as usize] = input;
                self.settle();
                for _ in 0..part.steps {
                    self.go(&part, 0, &mut 0);
                }
            }
            self.parts.push(part);
        }
    }

    /// One step, halved around a change of mode.
    fn go(&mut self, part: &Part, halving: usize, changes: &mut u32) {
        let steps = match self.mode {
            Mode::Stuck => &part.stuck,
            Mode::Slides(_) => &part.slides,
        };
        let next = &steps[halving] * &self.state;
        if self.holds(&next) {
            self.state = next;
        } else if halving < HALVINGS && *changes < CHANGES {
            self.go(part, halving + 1, changes);
            self.go(part, halving + 1, changes);
        } else {
            *changes += 1;
            self.state = next;
            if let Mode::Slides(_) = self.mode {
                self.state[self.plant.motor_velocity()] = 0.0;
                self.mode = Mode::Stuck;
            }
            self.settle();
        }
    }

    fn holds(&self, state: &DVector<f64>) -> bool {
        match self.mode {
            Mode::Stuck => self.push(state).abs() <= self.friction,
            Mode::Slides(sign) => sign * state[self.plant.motor_velocity()] >= 0.0,
        }
    }

    /// Lets go of a mass that is pushed harder than its friction, and sets the friction's torque.
    fn settle(&mut self) {
        let push = self.push(&self.state);
        if self.mode == Mode::Stuck && push.abs() > self.friction {
            self.mode = Mode::Slides(push.signum());
        }
        let torque = match self.mode {
            Mode::Stuck => 0.0,
            Mode::Slides(sign) => -sign * self.friction,
        };
        let n = self.plant.order();
        self.state[n + Input::Friction as usize] = torque;
    }

    /// Torque in N m of everything but friction on the motor's mass.
    fn push(&self, state: &DVector<f64>) -> f64 {
        let n = self.plant.order();
        let rates =
            self.plant.rates().row(self.plant.motor_velocity()).transpose().dot(&state.rows(0, n));
        let inputs = self.plant.inputs().row(self.plant.motor_velocity());
        let [motor, hand] = [Input::Motor, Input::Hand].map(|input| input as usize);
        // The sine is another torque of the hand.
        let hands = inputs[hand] * (state[n + hand] + state[n + INPUTS]);
        self.plant.motor_inertia() * (rates + inputs[motor] * state[n + motor] + hands)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_servo::scene::Device;

    fn friction_plant(friction: f64, velocity: f64) -> FrictionPlant {
        let plant = Plant::rigid(Device { inertia: 0.5, damping: 0.0, passivity: None });
        let discretization = Discretization::exact(0.25);
        FrictionPlant::new(&plant, friction, &discretization, 0.0, &plant.state_at(0.0, velocity))
    }

    #[test]
    fn a_sliding_mass_comes_to_rest_where_its_energy_is_used_up() {
        let mut mass = friction_plant(0.3, 2.0);
        for k in 0..40 {
            mass.tick(k, &TorqueSignal::Free, [0.0; 2]);
        }
        let way = 0.5 * 0.5 * 4.0 / 0.3;
        assert!((mass.state()[0] - way).abs() < 1e-9, "{}", mass.state()[0]);
        assert_eq!(mass.state()[1], 0.0);
    }

    #[test]
    fn a_stuck_mass_gives_way_only_to_more_than_its_friction() {
        let mut mass = friction_plant(0.3, 0.0);
        mass.tick(0, &TorqueSignal::Free, [0.0, 0.3]);
        assert_eq!(mass.state()[1], 0.0);
        mass.tick(1, &TorqueSignal::Free, [0.3, -0.4]);
        assert!((mass.state()[1] + 0.1 / 0.5 * 0.25).abs() < 1e-12);
    }
}
