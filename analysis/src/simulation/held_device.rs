//! A rigid device in a hand whose set-point moves, and the energy that passes between them.
//!
//! ```text
//! (m + m_h) x'' = u - b x' + k_h (p - x) + b_h (p' - x')
//! ```
//!
//! `x` angle of the device, `u` motor torque, `p` the hand's set-point; `m`, `b`
//! of the device, `m_h`, `b_h`, `k_h` of the hand. Over a tick `u` is held and `p` moves steadily.

use firmware::scene::Device;
use nalgebra::{DMatrix, DVector};

use super::discrete_plant::{DiscretePlant, Discretization};
use super::error::SimulationError;
use super::method::{Method, step};
use super::plant::{Input, POSITION, Plant, VELOCITY};
use crate::device::{Hand, HandSetpoint, Motion};

/// A device in a hand, ready to be stepped by whole ticks.
#[derive(Clone, Debug)]
pub struct HeldDevice {
    device: Device,
    period: f64,
    tick: DiscretePlant,
    /// `int x'^2 dt` over a tick as a quadratic form of [`at`] its start.
    velocity_energy: DMatrix<f64>,
}

impl HeldDevice {
    /// Solves the motion over one period of `period` s.
    ///
    /// # Errors
    /// Where device and hand are too fast for their motion over a period to be computed.
    pub fn new(device: Device, hand: Hand, period: f64) -> Result<Self, SimulationError> {
        let plant = Plant::rigid(device).with_moving_hand(hand);
        let tick = DiscretePlant::checked(&plant, &Discretization::exact(period), 0.0)?;
        Ok(Self { device, period, tick, velocity_energy: velocity_energy(&plant, period) })
    }

    /// One tick with the motor torque `motor` in N m held over it: the motion at its end, and the
    /// work in J that the hand did on the device.
    pub fn step(&self, motion: Motion, motor: f64, setpoint: HandSetpoint) -> (Motion, f64) {
        let speed = (setpoint.to - setpoint.from) / self.period;
        let state = DVector::from_vec(vec![motion.position, motion.velocity, setpoint.from]);
        let end = self.tick.end(&state, motor, speed);
        let next = Motion { position: end[POSITION], velocity: end[VELOCITY] };
        let start = at(state, self.velocity_energy.nrows(), motor, speed);
        let lost = self.device.damping * start.dot(&(&self.velocity_energy * &start));
        let gained = self.kinetic(next) - self.kinetic(motion);
        (next, gained + lost - motor * (next.position - motion.position))
    }

    fn kinetic(&self, motion: Motion) -> f64 {
        0.5 * self.device.inertia * motion.velocity * motion.velocity
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

/// `int x'^2 dt` over a period: by quadrature over a short time, doubled until it is the period.
fn velocity_energy(plant: &Plant, period: f64) -> DMatrix<f64> {
    let doublings = (FINENESS * plant.rates().amax() * period).log2().ceil().clamp(0.0, 1023.0);
    let short = period * (-doublings).exp2();
    let motion = |time: f64| step(plant, Method::Exact, 0.0, time);
    let mut transition = motion(short);
    let mut energy = DMatrix::zeros(transition.nrows(), transition.ncols());
    for (node, weight) in GAUSS {
        let velocity = motion(node * short).row(VELOCITY).transpose();
        energy.ger(weight * short, &velocity, &velocity, 1.0);
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

    const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

    #[test]
    fn free_device_follows_its_closed_form() {
        let held = HeldDevice::new(DEVICE, Hand::default(), 1e-3).unwrap();
        let start = Motion { position: 0.1, velocity: 2.0 };
        let torque = 0.05;
        let (end, work) = held.step(start, torque, HandSetpoint::default());
        // x'' = (u - b x') / m
        let (rate, last) = (DEVICE.damping / DEVICE.inertia, torque / DEVICE.damping);
        let decay = (-rate * 1e-3_f64).exp();
        let velocity = last + (start.velocity - last) * decay;
        let position =
            start.position + last * 1e-3 + (start.velocity - last) * (1.0 - decay) / rate;
        assert!((end.velocity - velocity).abs() < 1e-14, "{} {velocity}", end.velocity);
        assert!((end.position - position).abs() < 1e-16, "{} {position}", end.position);
        assert!(work.abs() < 1e-17, "no hand does no work, and did {work} J");
    }

    #[test]
    fn undamped_hand_and_spring_keep_their_energy() {
        let device = Device { damping: 0.0, ..DEVICE };
        let hand = Hand { inertia: 1e-4, damping: 0.0, stiffness: 5.0 };
        let held = HeldDevice::new(device, hand, 1e-3).unwrap();
        let mut motion = Motion { position: 0.1, velocity: 0.0 };
        let energy = |m: Motion| {
            0.5 * (device.inertia + hand.inertia) * m.velocity.powi(2)
                + 0.5 * hand.stiffness * m.position.powi(2)
        };
        let before = energy(motion);
        for _ in 0..10_000 {
            motion = held.step(motion, 0.0, HandSetpoint::default()).0;
        }
        assert!((energy(motion) / before - 1.0).abs() < 1e-10);
    }

    #[test]
    fn steps_of_half_a_period_are_the_same_motion() {
        let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 5.0 };
        for inertia in [1e-3, 2.2e-5, 1e-9, 1e-13] {
            let device = Device { inertia, ..DEVICE };
            let (whole, half) = (
                HeldDevice::new(device, hand, 1e-3).unwrap(),
                HeldDevice::new(device, hand, 5e-4).unwrap(),
            );
            let start = Motion { position: 0.02, velocity: -1.0 };
            let (end, work) = whole.step(start, 0.3, HandSetpoint { from: 0.1, to: 0.2 });
            let (middle, first) = half.step(start, 0.3, HandSetpoint { from: 0.1, to: 0.15 });
            let (same, second) = half.step(middle, 0.3, HandSetpoint { from: 0.15, to: 0.2 });
            assert!((end.position - same.position).abs() < 1e-13);
            assert!((end.velocity - same.velocity).abs() < 1e-10);
            assert!((work - first - second).abs() < 1e-12, "{work} {}", first + second);
        }
    }

    #[test]
    fn a_light_device_over_a_long_period_stays_finite() {
        let device = Device { inertia: 1e-12, ..DEVICE };
        let held = HeldDevice::new(device, Hand::default(), 0.1).unwrap();
        let (end, work) = held.step(Motion::default(), 0.022, HandSetpoint::default());
        assert!((end.velocity - 1.0).abs() < 1e-9 && (end.position - 0.1).abs() < 1e-9);
        assert!(work.abs() < 1e-9);
    }
}
