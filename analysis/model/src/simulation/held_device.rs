//! A rigid device in a hand whose set-point moves, and the energy that passes between them.
//!
//! ```text
//! (m + m_h) x'' = u - b x' + k_h (p - x) + b_h (p' - x')
//! ```
//!
//! `x` angle of the device, `u` motor torque, `p` the hand's set-point; `m`, `b`
//! of the device, `m_h`, `b_h`, `k_h` of the hand. Over a tick `p` moves steadily, and the commanded
//! torque changes once: at the beginning, or as much later as the output is delayed. An amplifier may lag
//! behind the command, and a filter behind the encoder. Friction and cogging of the motor may act besides.

use std::collections::VecDeque;

use haptic_servo::scene::{Device, Latency, Scene};
use nalgebra::{DMatrix, DVector};

use super::discrete_plant::{DiscretePlant, Discretization, Pieces};
use super::disturbed_plant::{DisturbedPlant, Step, TickInputs};
use super::error::SimulationError;
use super::method::{Method, step};
use super::plant::{INPUTS, Input, POSITION, Plant, VELOCITY};
use crate::device::{Hand, HandSetpoint, Motion};
use crate::disturbance::Disturbance;

/// State of the grip, behind the device's own two; those of the lags are behind it.
const GRIP: usize = 2;
/// State of the amplifier's torque, where the amplifier lags.
const TORQUE: usize = 3;

/// A device in a hand, ready to be stepped by whole ticks.
#[derive(Clone, Debug)]
pub struct HeldDevice {
    device: Device,
    period: f64,
    plant: Plant,
    discretization: Discretization,
    /// Whether the amplifier lags.
    lags: bool,
    /// Friction and cogging, and the plant with them, where there are any.
    disturbed: Option<(Disturbance, DisturbedPlant)>,
    /// The parts of a tick before its new torque, and those with it.
    parts: [Vec<Part>; 2],
}

/// The motion of a device, with the torques that have not acted on it yet.
#[derive(Clone, Debug)]
pub struct DeviceState {
    states: DVector<f64>,
    measured: usize,
    /// Commanded torques in N m of the ticks before, the newest first.
    torques: VecDeque<f64>,
}

impl DeviceState {
    /// The device's motion.
    pub fn motion(&self) -> Motion {
        Motion { position: self.states[POSITION], velocity: self.states[VELOCITY] }
    }

    /// The angle in rad at the encoder, or behind its filter.
    pub fn measured(&self) -> f64 {
        self.states[self.measured]
    }
}

impl HeldDevice {
    /// A scene's device, with the delay of its output and its lags.
    ///
    /// # Errors
    /// Where device and hand are too fast for their motion over a period to be computed.
    pub fn of(scene: &Scene, hand: Hand) -> Result<Self, SimulationError> {
        Self::lagging(scene.device, &scene.latency, hand, scene.timing.period)
    }

    fn lagging(
        device: Device,
        latency: &Latency,
        hand: Hand,
        period: f64,
    ) -> Result<Self, SimulationError> {
        let plant = Plant::rigid(device).with_moving_hand(hand).with_lags(latency, period);
        let discretization = Discretization::exact(period).delayed(latency, 0.0);
        discretization.at_updates(&plant)?;
        let lags = !latency.actuator_lag.is_zero();
        let part = |pieces: Pieces| Part::new(&plant, pieces, lags);
        let is_some = |pieces: &Pieces| pieces.count > 0 && pieces.length > 0.0;
        let [before, after] = discretization
            .pieces(&plant)
            .map(|pieces| pieces.into_iter().filter(is_some).map(part).collect::<Result<_, _>>());
        let (parts, disturbed) = ([before?, after?], None);
        Ok(Self { device, period, plant, discretization, lags, disturbed, parts })
    }

    /// The same with friction and cogging of the motor.
    pub fn with_disturbance(mut self, disturbance: Disturbance) -> Self {
        self.disturbed = (!disturbance.is_none()).then(|| {
            let plant = DisturbedPlant::new(&self.plant, disturbance, &self.discretization, 0.0);
            (disturbance, plant)
        });
        self
    }

    /// The state of a device that moves like this, without torque.
    pub fn at(&self, motion: Motion) -> DeviceState {
        DeviceState {
            states: self.plant.state_at(motion.position, motion.velocity),
            measured: self.plant.measured(),
            torques: VecDeque::from(vec![0.0; self.discretization.whole + 1]),
        }
    }

    /// One tick with the motor torque in N m of its sample: takes the state to the end of the tick, and
    /// returns the work in J that the hand did on the device.
    pub fn step(&self, state: &mut DeviceState, motor: f64, setpoint: HandSetpoint) -> f64 {
        state.torques.push_front(motor);
        let whole = self.discretization.whole;
        let [old, new] = [whole + 1, whole].map(|age| state.torques[age]);
        state.torques.pop_back();
        let speed = (setpoint.to - setpoint.from) / self.period;
        state.states[GRIP] = setpoint.from;
        if let Some((disturbance, plant)) = &self.disturbed {
            let inputs = TickInputs { hand: speed, sine: [0.0; 2], motor: [old, new] };
            return self.disturbed_step(state, disturbance, plant, &inputs);
        }
        let mut work = 0.0;
        let parts = self.parts.iter().zip([old, new]);
        let parts = parts.flat_map(|(parts, command)| parts.iter().map(move |it| (it, command)));
        for (part, command) in parts.flat_map(each) {
            let input = self.plant.motor_input(command, &state.states, part.since);
            let start = state.motion();
            let spent = part.spent(&self.device, &mut state.states, [command, input], speed);
            work += self.kinetic(state.motion()) - self.kinetic(start) + spent;
        }
        work
    }

    /// A tick with friction and cogging; the hand's work is that of steps in which the velocity goes in a
    /// straight line.
    fn disturbed_step(
        &self,
        state: &mut DeviceState,
        disturbance: &Disturbance,
        plant: &DisturbedPlant,
        inputs: &TickInputs,
    ) -> f64 {
        let start = state.motion();
        let mut disturbed = plant.at(&state.states);
        let mut spent = 0.0;
        plant.tick(&mut disturbed, inputs, |&Step { length, from, to, command }| {
            let [before, after] = [from, to].map(|states| states[VELOCITY]);
            let square = (before * before + before * after + after * after) / 3.0;
            let moved = to[POSITION] - from[POSITION];
            let torque = if self.lags { 0.5 * (from[TORQUE] + to[TORQUE]) } else { command };
            spent += self.device.damping * square * length + disturbance.friction * moved.abs()
                - torque * moved;
        });
        let n = state.states.len();
        state.states = disturbed.states().rows(0, n).into_owned();
        let end = state.motion();
        let [held, more] = [start, end].map(|it| disturbance.cogging.energy(it.position));
        self.kinetic(end) - self.kinetic(start) + more - held + spent
    }

    fn kinetic(&self, motion: Motion) -> f64 {
        0.5 * self.device.inertia * motion.velocity * motion.velocity
    }
}

/// A part of a tick, as many times as it is repeated.
fn each((part, command): (&Part, f64)) -> impl Iterator<Item = (&Part, f64)> {
    std::iter::repeat_n((part, command), part.count as usize)
}

/// A part of a tick over which the motor's input is held.
#[derive(Clone, Debug)]
struct Part {
    /// How often it is repeated: once, unless the amplifier is updated.
    count: u32,
    /// Time in s since the amplifier's last update at its beginning.
    since: f64,
    tick: DiscretePlant,
    /// `int x'^2 dt` over it as a quadratic form in [`at`] at its start.
    velocity_energy: DMatrix<f64>,
    /// `int u x' dt` likewise, where the amplifier lags; otherwise `u` is constant.
    motor_work: Option<DMatrix<f64>>,
}

impl Part {
    fn new(plant: &Plant, pieces: Pieces, lags: bool) -> Result<Self, SimulationError> {
        let Pieces { count, length, since, .. } = pieces;
        let (discretization, size) = (Discretization::exact(length), plant.order() + INPUTS + 2);
        let over = [DMatrix::identity(size, size), pieces.once(plant, Method::Exact, 0.0)];
        let tick = DiscretePlant::over(plant, over, &discretization, 0.0).finite(plant, length)?;
        let velocity_energy = integral(plant, length, [VELOCITY; 2]);
        let motor_work = lags.then(|| integral(plant, length, [VELOCITY, TORQUE]));
        Ok(Self { count, since, tick, velocity_energy, motor_work })
    }

    /// Takes the states to the end of the part, with a commanded torque and the motor's input that follows
    /// from it. Returns the energy in J that the device's damping took, less the energy that the motor gave.
    fn spent(
        &self,
        device: &Device,
        states: &mut DVector<f64>,
        [command, input]: [f64; 2],
        speed: f64,
    ) -> f64 {
        let end = self.tick.end(states, command, speed);
        let moved = end[POSITION] - states[POSITION];
        let rows = self.velocity_energy.nrows();
        let start = at(std::mem::replace(states, end), rows, input, speed);
        let form = |form: &DMatrix<f64>| start.dot(&(form * &start));
        let gained = self.motor_work.as_ref().map_or(command * moved, form);
        device.damping * form(&self.velocity_energy) - gained
    }
}

/// States with the inputs behind them, as [`step`] has them.
fn at(state: DVector<f64>, rows: usize, motor: f64, hand: f64) -> DVector<f64> {
    let order = state.len();
    let mut start = state.resize_vertically(rows, 0.0);
    start[order + Input::Motor as usize] = motor;
    start[order + Input::Hand as usize] = hand;
    start
}

/// Nodes on (0, 1) and weights of Gauss' and Legendre's rule with four points.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Steps of the quadrature in the shortest time constant: its relative error, of the eighth order,
/// is then below that of a double.
const FINENESS: f64 = 16.0;

/// The integral over `length` s of the product of two states, as a quadratic form: by quadrature over a
/// short time, doubled until it is the length.
fn integral(plant: &Plant, length: f64, states: [usize; 2]) -> DMatrix<f64> {
    let doublings = (FINENESS * plant.rates().amax() * length).log2().ceil().clamp(0.0, 1023.0);
    let short = length * (-doublings).exp2();
    let motion = |time: f64| step(plant, Method::Exact, 0.0, time);
    let mut transition = motion(short);
    let mut energy = DMatrix::zeros(transition.nrows(), transition.ncols());
    for (node, weight) in GAUSS {
        let motion = motion(node * short);
        let [first, second] = states.map(|state| motion.row(state).transpose());
        energy.ger(weight * short, &first, &second, 1.0);
    }
    for _ in 0..doublings as u32 {
        energy += transition.transpose() * &energy * &transition;
        transition = &transition * &transition;
    }
    energy
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::disturbance::sine;

    const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

    /// For torques without delay and lag.
    fn prompt(device: Device, hand: Hand, period: f64) -> Result<HeldDevice, SimulationError> {
        HeldDevice::lagging(device, &Latency::NONE, hand, period)
    }

    /// The motion after a tick, and the hand's work in it.
    fn stepped(
        held: &HeldDevice,
        start: Motion,
        torque: f64,
        setpoint: HandSetpoint,
    ) -> (Motion, f64) {
        let mut state = held.at(start);
        let work = held.step(&mut state, torque, setpoint);
        (state.motion(), work)
    }

    #[test]
    fn steps_of_half_a_period_are_the_same_motion() {
        let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 5.0 };
        for inertia in [1e-3, 2.2e-5, 1e-9, 1e-13] {
            let device = Device { inertia, ..DEVICE };
            let (whole, half) =
                (prompt(device, hand, 1e-3).unwrap(), prompt(device, hand, 5e-4).unwrap());
            let start = Motion { position: 0.02, velocity: -1.0 };
            let (end, work) = stepped(&whole, start, 0.3, HandSetpoint { from: 0.1, to: 0.2 });
            let (middle, first) = stepped(&half, start, 0.3, HandSetpoint { from: 0.1, to: 0.15 });
            let (same, second) = stepped(&half, middle, 0.3, HandSetpoint { from: 0.15, to: 0.2 });
            assert!((end.position - same.position).abs() < 1e-13);
            assert!((end.velocity - same.velocity).abs() < 1e-10);
            assert!((work - first - second).abs() < 1e-12, "{work} {}", first + second);
        }
    }

    /// A delay of 2.25 periods against ticks of a quarter of a period without delay.
    #[test]
    fn a_torque_acts_from_its_delay_on() {
        let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 5.0 };
        let latency = Latency::delayed(2.25e-3);
        let late = HeldDevice::lagging(DEVICE, &latency, hand, 1e-3).unwrap();
        let quarter = prompt(DEVICE, hand, 2.5e-4).unwrap();
        let torques = [0.3, -0.1, 0.2, 0.05, -0.4, 0.1, 0.0, 0.15];
        let start = Motion { position: 0.02, velocity: -1.0 };
        let (mut state, mut fine) = (late.at(start), quarter.at(start));
        let place = |time: f64| 0.05 + 0.02 * time;
        for (tick, &torque) in torques.iter().enumerate() {
            let setpoint = |from: f64, to: f64| HandSetpoint { from: place(from), to: place(to) };
            let work = late.step(&mut state, torque, setpoint(tick as f64, tick as f64 + 1.0));
            let mut parts = 0.0;
            for part in 0..4 {
                let index = (4 * tick + part).checked_sub(9).map(|since| since / 4);
                let torque = index.map_or(0.0, |index| torques[index]);
                let at = tick as f64 + 0.25 * f64::from(part as u32);
                parts += quarter.step(&mut fine, torque, setpoint(at, at + 0.25));
            }
            let (end, same) = (state.motion(), fine.motion());
            assert!((end.position - same.position).abs() < 1e-14, "tick {tick}");
            assert!((end.velocity - same.velocity).abs() < 1e-11, "tick {tick}");
            assert!((work - parts).abs() < 1e-14, "tick {tick}: {work} {parts}");
        }
    }

    /// A delay of three updates, with five updates in a period, against short ticks without delay: each holds
    /// the torque in the middle of its part of the straight line between two updates.
    #[test]
    fn the_torque_of_an_amplifier_in_updates_goes_in_straight_lines() {
        const FINE: usize = 64;
        let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 5.0 };
        let (period, lag) = (1e-3, 3e-4);
        let sampled = Latency::sampled(5, lag, period);
        let output_delay = haptic_servo::latency::TimeRange::exactly(6e-4);
        let latency = Latency { output_delay, ..sampled };
        let late = HeldDevice::lagging(DEVICE, &latency, hand, period).unwrap();
        let short = prompt(DEVICE, hand, period / (5 * FINE) as f64).unwrap();
        let start = Motion { position: 0.02, velocity: -1.0 };
        let (mut state, mut fine) = (late.at(start), short.at(start));
        let left = (-period / 5.0 / lag).exp();
        let (mut torque, mut commanded) = (0.0, 0.0);
        for command in [0.3, -0.1, 0.2, 0.05, -0.4, 0.1] {
            let setpoint = HandSetpoint { from: 0.05, to: 0.05 };
            let work = late.step(&mut state, command, setpoint);
            let mut parts = 0.0;
            for update in 0..5 {
                if update == 3 {
                    commanded = command;
                }
                let end = commanded + (torque - commanded) * left;
                for part in 0..FINE {
                    let share = (part as f64 + 0.5) / FINE as f64;
                    parts += short.step(&mut fine, torque + (end - torque) * share, setpoint);
                }
                torque = end;
            }
            let (end, same) = (state.motion(), fine.motion());
            assert!((end.position - same.position).abs() < 1e-8, "{end:?} {same:?}");
            assert!((end.velocity - same.velocity).abs() < 1e-4, "{end:?} {same:?}");
            assert!((work - parts).abs() < 1e-6, "{work} {parts}");
        }
        let between = Latency::delayed(5e-4);
        let between = Latency { output_delay: between.output_delay, ..latency };
        let refused = HeldDevice::lagging(DEVICE, &between, hand, period).unwrap_err();
        assert!(refused.to_string().contains("between two updates"), "{refused}");
    }

    /// With next to no friction and cogging a device moves as without, also behind lags and delays; with some
    /// it stands still where the hand and the motor together are too weak, and a free one gets no work.
    #[test]
    fn friction_and_cogging_hold_a_device() {
        let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 5.0 };
        let cogging = sine(1e-15, 84.0);
        let few = Disturbance { friction: 1e-15, cogging };
        let latency = Latency::delayed(1.25e-3).with_actuator_lag(2e-4);
        let plain = HeldDevice::lagging(DEVICE, &latency, hand, 1e-3).unwrap();
        let disturbed = plain.clone().with_disturbance(few);
        let start = Motion { position: 0.02, velocity: -1.0 };
        let (mut state, mut same) = (plain.at(start), disturbed.at(start));
        for torque in [0.3, -0.1, 0.2, 0.05, -0.4, 0.1] {
            let setpoint = HandSetpoint { from: 0.02, to: 0.03 };
            let work = plain.step(&mut state, torque, setpoint);
            let other = disturbed.step(&mut same, torque, setpoint);
            let [one, two] = [&state, &same].map(DeviceState::motion);
            assert!((one.position - two.position).abs() < 1e-9, "{one:?} {two:?}");
            assert!((one.velocity - two.velocity).abs() < 1e-6, "{one:?} {two:?}");
            // Of the second order in the steps, of which the lag is two.
            assert!((work - other).abs() < 0.1 * work.abs(), "{work} {other}");
        }
        let cogging = sine(0.03, 84.0);
        let held = plain.with_disturbance(Disturbance { friction: 0.02, cogging });
        let mut state = held.at(Motion { position: 0.25 * cogging.pitch(), velocity: 0.0 });
        // The cogging pushes back with its 0.03 N m, more than the friction: the device moves, and sticks.
        let still = HandSetpoint { from: 0.0, to: 0.0 };
        for _ in 0..200 {
            held.step(&mut state, 0.0, still);
        }
        let rest = state.motion();
        assert_eq!(rest.velocity, 0.0);
        let torque = cogging.at(rest.position) - 5.0 * rest.position;
        assert!(torque.abs() <= 0.02, "{rest:?} {torque}");
        let free = HeldDevice::lagging(DEVICE, &Latency::NONE, Hand::default(), 1e-3).unwrap();
        let free = free.with_disturbance(Disturbance { friction: 0.002, cogging });
        let mut state = free.at(Motion::default());
        let mut work = 0.0;
        for _ in 0..100 {
            work += free.step(&mut state, 0.04, still);
        }
        let given = 0.04 * state.motion().position;
        assert!(given > 1e-3 && work.abs() < 1e-3 * given, "{work} {given}");
    }

    /// A free device behind an amplifier that lags, in closed form; and no hand does no work.
    #[test]
    fn an_amplifier_s_torque_follows_its_command() {
        let (lag, period, torque) = (5.3e-5, 1e-3, 0.05);
        let latency = Latency::NONE.with_actuator_lag(lag);
        let held = HeldDevice::lagging(DEVICE, &latency, Hand::default(), period).unwrap();
        let mut state = held.at(Motion::default());
        let work = held.step(&mut state, torque, HandSetpoint::default());
        // v' = (u (1 - exp(-t / tau)) - b v) / m: a sum of 1 and of both exponentials.
        let rate = DEVICE.damping / DEVICE.inertia;
        let part = torque / DEVICE.inertia / (rate - 1.0 / lag);
        let last = torque / DEVICE.damping;
        let at = |rate: f64| (-rate * period).exp();
        let velocity = last - part * at(1.0 / lag) + (part - last) * at(rate);
        assert!((state.motion().velocity / velocity - 1.0).abs() < 1e-11, "{velocity}");
        assert!(work.abs() < 1e-16, "no hand does no work, and did {work} J");
    }
}
