//! The paddle in a hand, driven by the torque of a motor.

use std::f64::consts::TAU;

use virtual_board::device::{Device, Motion};

use super::bridge_wall::{SCENE, TRANSDUCERS};

/// Torque of the hand in N m, by the seconds since the motor was first switched on.
pub type HandTorque = fn(f64) -> f64;

/// The device of the program, with friction, in a hand that pushes with a torque.
pub struct Paddle {
    hand: HandTorque,
    /// Coulomb friction in N m.
    friction: f64,
    angle: f64,
    speed: f64,
    count: i32,
    /// Seconds since the motor was first switched on.
    time: Option<f64>,
}

impl Paddle {
    /// At rest, half a count above zero.
    pub fn new(hand: HandTorque, friction: f64) -> Self {
        let angle = 0.5 * TAU / TRANSDUCERS.counts_per_turn;
        Self { hand, friction, angle, speed: 0.0, count: 0, time: None }
    }

    /// One that nobody touches.
    pub fn still() -> Self {
        Self::new(|_| 0.0, 0.0)
    }
}

impl Device for Paddle {
    fn sample(&mut self, _: Option<u16>, is_on: bool) -> i32 {
        if is_on {
            self.time.get_or_insert(0.0);
        }
        0
    }

    /// The speed at the end, by the torques and the friction at it, which may hold the paddle; and with it
    /// the angle.
    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        let hand = self.time.map_or(0.0, self.hand);
        self.time = self.time.map(|time| time + seconds);
        let inertia = SCENE.device.inertia;
        let pushed = inertia * self.speed + (torque + hand) * seconds;
        let held = self.friction * seconds;
        let left = (pushed.abs() - held).max(0.0) * pushed.signum();
        self.speed = left / (inertia + SCENE.device.damping * seconds);
        self.angle += self.speed * seconds;
        let count = (self.angle * TRANSDUCERS.counts_per_turn / TAU).floor() as i32;
        let counts = count - std::mem::replace(&mut self.count, count);
        Motion { counts, angle: self.angle, speed: self.speed }
    }
}
