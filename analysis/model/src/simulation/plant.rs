//! The machine as a linear system in continuous time: masses in a row, a hand at the last of them,
//! and an amplifier and a sensor that may lag.
//!
//! ```text
//! m_i v_i' = (forces of the two links and of the ground) + (motor torque on i = 1)
//!            + (hand's torque on the last i) - (friction on i = 1)
//! ```
//!
//! States: `x_1, v_1, x_2, v_2, ..`, then the torque of the amplifier and the angle behind the
//! encoder's filter, where these lag. The mass with the encoder comes first: that is the motor's, or
//! has changed places with it. All torques are positive in the direction of the angle.

use haptic_servo::scene::{Device, Latency};
use nalgebra::{DMatrix, DVector};

use crate::chain::{Chain, Link, Mass};
use crate::device::Hand;
use crate::sampled_actuator::SampledActuator;

/// Inputs of the plant: the columns of [`Plant::inputs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Input {
    /// Torque commanded to the amplifier, on the motor's mass.
    Motor = 0,
    /// Torque of the hand, on the mass that it holds; the speed of its grip where that [moves].
    ///
    /// [moves]: Plant::with_moving_hand
    Hand = 1,
    /// Torque of dry friction, on the motor's mass.
    Friction = 2,
}

/// Number of inputs.
pub const INPUTS: usize = 3;

/// State of the encoder's position.
pub const POSITION: usize = 0;
/// State of the encoder's velocity.
pub const VELOCITY: usize = 1;

/// `x' = A x + B u`.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    masses: Vec<Mass>,
    motor: usize,
    hand: usize,
    measured: usize,
    /// The amplifier and the state of its torque, where it is updated N times in a tick.
    sampled: Option<(SampledActuator, usize)>,
    rates: DMatrix<f64>,
    inputs: DMatrix<f64>,
}

impl Plant {
    /// A rigid device.
    pub fn rigid(device: Device) -> Self {
        Self::chain(&[Mass { inertia: device.inertia, damping: device.damping }], &[])
    }

    /// A device as a file describes it, with its amplifier.
    pub fn of(chain: &Chain) -> Self {
        let plant = Self::with_encoder_at(chain.encoder_mass(), chain.masses(), chain.links());
        let lag = chain.actuator_lag();
        if lag > 0.0 { plant.with_actuator_lag(lag) } else { plant }
    }

    /// Masses in a row from the motor to the hand, with a link between each and the next, the encoder on the
    /// motor's; missing links connect nothing.
    ///
    /// # Panics
    /// Without a mass, or with a mass whose inertia is not positive: there is no such machine.
    pub fn chain(masses: &[Mass], links: &[Link]) -> Self {
        Self::with_encoder_at(0, masses, links)
    }

    /// The same with the encoder on any of the masses, counted from the motor's.
    ///
    /// # Panics
    /// As [`Plant::chain`], and where there is no such mass.
    pub fn with_encoder_at(encoder: usize, masses: &[Mass], links: &[Link]) -> Self {
        assert!(encoder < masses.len() && masses.iter().all(|mass| mass.inertia > 0.0));
        // The encoder's mass and the motor's change places.
        let place = |mass: usize| match mass {
            0 => encoder,
            mass if mass == encoder => 0,
            mass => mass,
        };
        let n = 2 * masses.len();
        let (mut rates, mut inputs) = (DMatrix::zeros(n, n), DMatrix::zeros(n, INPUTS));
        let mut placed = masses.to_vec();
        placed.swap(0, encoder);
        for (i, mass) in placed.iter().enumerate() {
            rates[(2 * i, 2 * i + 1)] = 1.0;
            rates[(2 * i + 1, 2 * i + 1)] = -mass.damping / mass.inertia;
        }
        let (motor, hand) = (place(0), place(masses.len() - 1));
        for (input, at) in [(Input::Motor, motor), (Input::Friction, motor), (Input::Hand, hand)] {
            inputs[(2 * at + 1, input as usize)] = 1.0 / placed[at].inertia;
        }
        let mut plant =
            Self { masses: placed, motor, hand, measured: POSITION, sampled: None, rates, inputs };
        for (i, link) in links.iter().enumerate().take(masses.len() - 1) {
            for (here, there) in [(i, i + 1), (i + 1, i)] {
                plant.pull(place(here), place(there), masses[here].inertia, *link);
            }
        }
        plant
    }

    fn pull(&mut self, here: usize, there: usize, inertia: f64, link: Link) {
        for (offset, gain) in [(0, link.stiffness / inertia), (1, link.damping / inertia)] {
            self.rates[(2 * here + 1, 2 * here + offset)] -= gain;
            self.rates[(2 * here + 1, 2 * there + offset)] += gain;
        }
    }

    /// The same with a hand: its inertia moves with the mass that it holds, its spring and damper
    /// go to the ground.
    pub fn with_hand(mut self, hand: Hand) -> Self {
        let (position, velocity) = (2 * self.hand, 2 * self.hand + 1);
        let before = self.masses[self.hand].inertia;
        let inertia = before + hand.inertia;
        self.masses[self.hand].inertia = inertia;
        self.rates.row_mut(velocity).scale_mut(before / inertia);
        self.inputs.row_mut(velocity).scale_mut(before / inertia);
        self.rates[(velocity, position)] -= hand.stiffness / inertia;
        self.rates[(velocity, velocity)] -= hand.damping / inertia;
        self
    }

    /// The same with one more mass, on a spring at the mass that the hand holds. For a plant without lags
    /// and without a grip that moves, whose states come behind those of the masses.
    pub fn with_absorber(mut self, inertia: f64, stiffness: f64) -> Self {
        let n = self.order();
        debug_assert_eq!(n, 2 * self.masses.len());
        self.rates = self.rates.resize(n + 2, n + 2, 0.0);
        self.inputs = self.inputs.resize(n + 2, INPUTS, 0.0);
        self.masses.push(Mass { inertia, damping: 0.0 });
        self.rates[(n, n + 1)] = 1.0;
        let (held, added) = (self.hand, self.masses.len() - 1);
        let spring = Link { stiffness, damping: 0.0 };
        self.pull(held, added, self.masses[held].inertia, spring);
        self.pull(added, held, inertia, spring);
        self
    }

    /// The same with one more state, whose number it returns.
    fn with_state(mut self) -> (Self, usize) {
        let n = self.order();
        self.rates = self.rates.resize(n + 1, n + 1, 0.0);
        self.inputs = self.inputs.resize(n + 1, INPUTS, 0.0);
        (self, n)
    }

    /// The same in a hand whose grip moves: its spring and damper go to a point of its own, whose
    /// angle is one more state and whose velocity in rad/s takes the place of the hand's torque.
    pub fn with_moving_hand(self, hand: Hand) -> Self {
        let (mut held, grip) = self.with_hand(hand).with_state();
        let (velocity, inertia) = (2 * held.hand + 1, held.masses[held.hand].inertia);
        let input = Input::Hand as usize;
        held.rates[(velocity, grip)] = hand.stiffness / inertia;
        held.inputs.column_mut(input).fill(0.0);
        held.inputs[(velocity, input)] = hand.damping / inertia;
        held.inputs[(grip, input)] = 1.0;
        held
    }

    /// The same with an amplifier whose torque follows the command with the time constant `lag`
    /// in s, greater than zero.
    pub fn with_actuator_lag(self, lag: f64) -> Self {
        let (mut plant, torque) = self.with_state();
        let motor = Input::Motor as usize;
        plant.rates.column_mut(torque).copy_from(&plant.inputs.column(motor));
        plant.rates[(torque, torque)] = -1.0 / lag;
        plant.inputs.column_mut(motor).fill(0.0);
        plant.inputs[(torque, motor)] = 1.0 / lag;
        plant
    }

    /// The same with an amplifier that is updated N times in a tick: the motor's input is then the
    /// [slope](Plant::motor_input) of its torque.
    pub fn with_sampled_actuator(self, actuator: SampledActuator) -> Self {
        let torque = self.order();
        let mut plant = self.with_actuator_lag(1.0);
        plant.rates[(torque, torque)] = 0.0;
        Self { sampled: Some((actuator, torque)), ..plant }
    }

    /// The same with a filter between encoder and servo, which lags by a time in s.
    pub fn with_sensor_lag(self, lag: f64) -> Self {
        let (mut plant, angle) = self.with_state();
        plant.rates[(angle, plant.measured)] = 1.0 / lag;
        plant.rates[(angle, angle)] = -1.0 / lag;
        Self { measured: angle, ..plant }
    }

    /// The same with the lags of a scene of this period in s at its two ends; a lag that lies in a range has
    /// the middle of it.
    pub fn with_lags(mut self, latency: &Latency, period: f64) -> Self {
        let Latency { actuator_lag, sensor_lag, .. } = *latency;
        if let Some(actuator) = SampledActuator::of(latency, period) {
            self = self.with_sampled_actuator(actuator);
        } else if !actuator_lag.is_zero() {
            self = self.with_actuator_lag(actuator_lag.middle());
        }
        if !sensor_lag.is_zero() {
            self = self.with_sensor_lag(sensor_lag.middle());
        }
        self
    }

    /// The same with the motor's mass held in place by its friction.
    pub fn with_motor_stuck(mut self) -> Self {
        for row in [2 * self.motor, self.motor_velocity()] {
            self.rates.row_mut(row).fill(0.0);
            self.inputs.row_mut(row).fill(0.0);
        }
        self
    }

    /// The amplifier, if it is updated N times in a tick.
    pub fn sampled(&self) -> Option<SampledActuator> {
        self.sampled.map(|(actuator, _)| actuator)
    }

    /// The motor's input until the next update, for a commanded torque in N m and states `since` s after the last
    /// update: that torque, or the slope of the amplifier's in N m/s.
    pub fn motor_input(&self, command: f64, states: &DVector<f64>, since: f64) -> f64 {
        self.sampled.map_or(command, |(actuator, torque)| {
            actuator.slope(since) * (command - states[torque])
        })
    }

    /// Converts a matrix of states and inputs up to an update, from `since` s after the last one: its motor input, that
    /// of [`Plant::motor_input`], becomes the command.
    pub fn commanded(&self, mut through: DMatrix<f64>, since: f64) -> DMatrix<f64> {
        let Some((actuator, torque)) = self.sampled else { return through };
        let (n, slope) = (self.order(), actuator.slope(since));
        let motor = n + Input::Motor as usize;
        for row in 0..n {
            let driven = slope * through[(row, motor)];
            through[(row, motor)] = driven;
            through[(row, torque)] -= driven;
        }
        through
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.rates.nrows()
    }

    /// Number of masses; their positions are the even states below twice this.
    pub fn masses(&self) -> usize {
        self.masses.len()
    }

    /// The state that the servo reads: the encoder's position, or the output of its filter.
    pub fn measured(&self) -> usize {
        self.measured
    }

    /// The state that is the position of the motor's mass.
    pub fn motor_position(&self) -> usize {
        2 * self.motor
    }

    /// The state that is the velocity of the motor's mass.
    pub fn motor_velocity(&self) -> usize {
        2 * self.motor + 1
    }

    /// Inertia in kg m^2 of the motor's mass with all that moves with it.
    pub fn motor_inertia(&self) -> f64 {
        self.masses[self.motor].inertia
    }

    /// `A`, in 1/s and the units of the states.
    pub fn rates(&self) -> &DMatrix<f64> {
        &self.rates
    }

    /// `B`, one column an [`Input`].
    pub fn inputs(&self) -> &DMatrix<f64> {
        &self.inputs
    }

    /// The state with all masses at `position` (rad) and `velocity` (rad/s): the device moves as
    /// one, so that no link is stretched. The encoder's filter shows that position, the amplifier gives
    /// no torque, a grip that moves is at 0.
    pub fn state_at(&self, position: f64, velocity: f64) -> DVector<f64> {
        DVector::from_fn(self.order(), |row, _| match (row < 2 * self.masses.len(), row % 2) {
            (true, 0) => position,
            (true, _) => velocity,
            (false, _) if row == self.measured => position,
            (false, _) => 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_masses_in_a_hand_with_a_lagging_amplifier() {
        let masses = [Mass { inertia: 2.0, damping: 3.0 }, Mass { inertia: 4.0, damping: 5.0 }];
        let links = [Link { stiffness: 7.0, damping: 11.0 }];
        let hand = Hand { inertia: 1.0, damping: 13.0, stiffness: 17.0 };
        let plant = Plant::chain(&masses, &links).with_hand(hand).with_actuator_lag(0.5);
        let state = DVector::from_vec(vec![0.1, 0.2, 0.3, 0.4, 0.6]);
        let inputs = DVector::from_vec(vec![1.5, 0.7, -0.9]);
        let rate = plant.rates() * &state + plant.inputs() * inputs;
        let link = 7.0 * (0.3 - 0.1) + 11.0 * (0.4 - 0.2);
        let should = [
            0.2,
            (-3.0 * 0.2 + link + 0.6 - 0.9) / 2.0,
            0.4,
            (-5.0 * 0.4 - link - 17.0 * 0.3 - 13.0 * 0.4 + 0.7) / 5.0,
            (1.5 - 0.6) / 0.5,
        ];
        for (is, should) in rate.iter().zip(should) {
            assert!((is - should).abs() < 1e-14, "{is} {should}");
        }
        // The same machine from its other end.
        let seen =
            Plant::with_encoder_at(1, &masses, &links).with_hand(hand).with_actuator_lag(0.5);
        let state = DVector::from_vec(vec![0.3, 0.4, 0.1, 0.2, 0.6]);
        let rate = seen.rates() * &state + seen.inputs() * DVector::from_vec(vec![1.5, 0.7, -0.9]);
        for (is, should) in rate.iter().zip([2, 3, 0, 1, 4].map(|row| should[row])) {
            assert!((is - should).abs() < 1e-14, "{is} {should}");
        }
    }
}
