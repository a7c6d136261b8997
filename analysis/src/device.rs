//! The machine under the servo, simulated exactly: a mass with a damper, and a passive hand on it.
//!
//! Between two updates the motor torque is constant (zero-order hold) and the point that the hand
//! wants to be at moves steadily, so the motion is that of a linear system with held inputs, and
//! its matrix exponential gives the next sample without any step size (theory, section 9).
//!
//! ```text
//! (m + m_h) x'' = u - b x' + k_h (p - x) + b_h (p' - x')
//! ```
//!
//! `x` angle of the device, `u` motor torque, `p` the point that the hand wants to be at; `m`, `b`
//! of the device, `m_h`, `b_h`, `k_h` of the hand.

use firmware::scene::Device;
use nalgebra::SMatrix;
use serde::Serialize;

/// State and held inputs: `x`, `x'`, `p`, `p'`, `u`.
const SIZE: usize = 5;
type Square = SMatrix<f64, SIZE, SIZE>;
type Augmented = nalgebra::SVector<f64, SIZE>;

const X: usize = 0;
const V: usize = 1;
const P: usize = 2;
const W: usize = 3;
const U: usize = 4;

/// A passive hand that holds the device; all three are 0 or more, and all zero is no hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hand {
    /// Inertia `m_h` in kg m^2 that moves with the device.
    pub inertia: f64,
    /// Damping `b_h` in N m s/rad towards the point where the hand wants to be.
    pub damping: f64,
    /// Stiffness `k_h` in N m/rad towards the same point.
    pub stiffness: f64,
}

/// How the device moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Angle in rad.
    pub position: f64,
    /// Angular velocity in rad/s.
    pub velocity: f64,
}

/// Where the hand wants to be, over one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip {
    /// Angle in rad at the start of the tick.
    pub from: f64,
    /// Angle in rad at its end.
    pub to: f64,
}

/// Energy in J that passed between hand and device.
///
/// In every tick the work of the hand's torque on the device is computed exactly from the energy
/// balance of the bare device, `W = d(m x'^2 / 2) + b int x'^2 dt - u dx`. Work that is positive
/// over a tick counts as given, work that is negative as got back, so a hand that pushes a spring
/// in and eases out again gives and gets back about the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energy {
    /// What the hand put in.
    pub given: f64,
    /// What the device returned to the hand.
    pub got_back: f64,
}

impl Energy {
    /// Adds one tick's work of the hand on the device, in J.
    pub fn add(&mut self, work: f64) {
        if work > 0.0 {
            self.given += work;
        } else {
            self.got_back -= work;
        }
    }
}

/// A device in a hand, ready to be stepped by whole ticks.
#[derive(Clone, Debug)]
pub struct HeldDevice {
    device: Device,
    period: f64,
    /// State and inputs at the end of a tick from those at its start.
    transition: Square,
    /// `int x'^2 dt` over a tick as a quadratic form of state and inputs at its start.
    velocity_energy: Square,
}

impl HeldDevice {
    /// Solves the motion over one period of `period` s.
    pub fn new(device: Device, hand: Hand, period: f64) -> Self {
        let generator = generator(device, hand);
        let (transition, velocity_energy) = integrate(&generator, period);
        Self { device, period, transition, velocity_energy }
    }

    /// One tick with the motor torque `motor` in N m held over it: the motion at its end, and the
    /// work in J that the hand did on the device.
    pub fn step(&self, motion: Motion, motor: f64, grip: Grip) -> (Motion, f64) {
        let speed = (grip.to - grip.from) / self.period;
        let start = Augmented::from([motion.position, motion.velocity, grip.from, speed, motor]);
        let end = self.transition * start;
        let next = Motion { position: end[X], velocity: end[V] };
        let lost = self.device.damping * start.dot(&(self.velocity_energy * start));
        let gained = self.kinetic(next) - self.kinetic(motion);
        (next, gained + lost - motor * (next.position - motion.position))
    }

    fn kinetic(&self, motion: Motion) -> f64 {
        0.5 * self.device.inertia * motion.velocity * motion.velocity
    }
}

/// `d/dt` of state and inputs.
fn generator(device: Device, hand: Hand) -> Square {
    let inertia = device.inertia + hand.inertia;
    let mut a = Square::zeros();
    a[(X, V)] = 1.0;
    a[(V, X)] = -hand.stiffness / inertia;
    a[(V, V)] = -(device.damping + hand.damping) / inertia;
    a[(V, P)] = hand.stiffness / inertia;
    a[(V, W)] = hand.damping / inertia;
    a[(V, U)] = 1.0 / inertia;
    a[(P, W)] = 1.0;
    a
}

/// `exp(A T)`, and the integral over the tick of `exp(A t)' diag(x'^2) exp(A t)`.
///
/// Both are taken over so short a time that the matrix exponential of Van Loan's block matrix is
/// accurate, then doubled: the block matrix contains `exp(-A T)`, which overflows for a light
/// device over a whole period.
fn integrate(a: &Square, period: f64) -> (Square, Square) {
    let doublings = (a.amax() * period).log2().ceil().clamp(0.0, 1023.0) as i32;
    let short = period * 2f64.powi(-doublings);
    let mut block = SMatrix::<f64, { 2 * SIZE }, { 2 * SIZE }>::zeros();
    block.fixed_view_mut::<SIZE, SIZE>(0, 0).copy_from(&(-a.transpose() * short));
    block[(V, SIZE + V)] = short;
    block.fixed_view_mut::<SIZE, SIZE>(SIZE, SIZE).copy_from(&(a * short));
    let exponential = block.exp();
    let mut transition: Square = exponential.fixed_view::<SIZE, SIZE>(SIZE, SIZE).into_owned();
    let mut energy =
        transition.transpose() * exponential.fixed_view::<SIZE, SIZE>(0, SIZE).into_owned();
    for _ in 0..doublings {
        energy += transition.transpose() * energy * transition;
        transition *= transition;
    }
    (transition, energy)
}

/// What an incremental encoder makes of an angle: the whole counts below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedEncoder {
    counts_per_radian: f64,
}

impl SimulatedEncoder {
    /// An encoder with so many counts a turn.
    pub fn new(counts_per_turn: f64) -> Self {
        Self { counts_per_radian: counts_per_turn / std::f64::consts::TAU }
    }

    /// The 32-bit counter at an angle in rad; it wraps.
    pub fn read(&self, position: f64) -> i32 {
        (position * self.counts_per_radian).floor() as i64 as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

    #[test]
    fn free_device_follows_its_closed_form() {
        let held = HeldDevice::new(DEVICE, Hand::default(), 1e-3);
        let start = Motion { position: 0.1, velocity: 2.0 };
        let torque = 0.05;
        let (end, work) = held.step(start, torque, Grip::default());
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
        let held = HeldDevice::new(device, hand, 1e-3);
        let mut motion = Motion { position: 0.1, velocity: 0.0 };
        let energy = |m: Motion| {
            0.5 * (device.inertia + hand.inertia) * m.velocity.powi(2)
                + 0.5 * hand.stiffness * m.position.powi(2)
        };
        let before = energy(motion);
        for _ in 0..10_000 {
            motion = held.step(motion, 0.0, Grip::default()).0;
        }
        assert!((energy(motion) / before - 1.0).abs() < 1e-10);
    }

    #[test]
    fn steps_of_half_a_period_are_the_same_motion() {
        let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 5.0 };
        for inertia in [1e-3, 2.2e-5, 1e-9, 1e-13] {
            let device = Device { inertia, ..DEVICE };
            let (whole, half) =
                (HeldDevice::new(device, hand, 1e-3), HeldDevice::new(device, hand, 5e-4));
            let start = Motion { position: 0.02, velocity: -1.0 };
            let (end, work) = whole.step(start, 0.3, Grip { from: 0.1, to: 0.2 });
            let (middle, first) = half.step(start, 0.3, Grip { from: 0.1, to: 0.15 });
            let (same, second) = half.step(middle, 0.3, Grip { from: 0.15, to: 0.2 });
            assert!((end.position - same.position).abs() < 1e-13);
            assert!((end.velocity - same.velocity).abs() < 1e-10);
            assert!((work - first - second).abs() < 1e-12, "{work} {}", first + second);
        }
    }

    #[test]
    fn a_light_device_over_a_long_period_stays_finite() {
        let device = Device { inertia: 1e-12, ..DEVICE };
        let held = HeldDevice::new(device, Hand::default(), 0.1);
        let (end, work) = held.step(Motion::default(), 0.022, Grip::default());
        assert!((end.velocity - 1.0).abs() < 1e-9 && (end.position - 0.1).abs() < 1e-9);
        assert!(work.abs() < 1e-9);
    }

    #[test]
    fn encoder_floors_and_wraps() {
        let encoder = SimulatedEncoder::new(std::f64::consts::TAU * 10.0);
        assert_eq!(encoder.read(0.19), 1);
        assert_eq!(encoder.read(-0.01), -1);
        assert_eq!(encoder.read(214_748_364.85), i32::MIN);
    }
}
