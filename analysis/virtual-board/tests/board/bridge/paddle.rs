//! What a motor turns: the paddle in a hand, or a shaft of its own.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

use virtual_board::device::{Device, Motion};

use haptic_servo::scene::Device as Mechanics;

use super::{bridge_wall, brushless_wall};

/// Torque of the hand in N m, by the seconds since the motor was first switched on.
pub type HandTorque = Box<dyn Fn(f64) -> f64 + Send>;

/// Damping of a hand in N m s/rad on the shaft, which keeps its speed within the limit.
const HAND_DAMPING: f64 = 0.005;

/// The device of a program, with friction, in a hand that pushes with a torque.
pub struct Paddle {
    hand: HandTorque,
    mechanics: Mechanics,
    counts_per_turn: f64,
    /// Coulomb friction in N m.
    friction: f64,
    angle: f64,
    speed: f64,
    count: i32,
    /// Seconds since the motor was first switched on.
    time: Option<f64>,
}

impl Paddle {
    /// The paddle of `bridge_wall` at rest, half a count above zero.
    pub fn new(hand: impl Fn(f64) -> f64 + Send + 'static, friction: f64) -> Self {
        let counts = bridge_wall::TRANSDUCERS.counts_per_turn;
        Self::of(bridge_wall::SCENE.device, counts, Box::new(hand), friction)
    }

    /// The shaft of `brushless_wall` with some friction, in a hand with this torque, from the first moment
    /// on.
    pub fn shaft(torque: Arc<Mutex<f64>>) -> Self {
        let counts = brushless_wall::TRANSDUCERS.counts_per_turn;
        let mechanics = Mechanics { damping: HAND_DAMPING, ..brushless_wall::SCENE.device };
        let hand = Box::new(move |_| *torque.lock().unwrap());
        Self { time: Some(0.0), ..Self::of(mechanics, counts, hand, 0.002) }
    }

    fn of(mechanics: Mechanics, counts_per_turn: f64, hand: HandTorque, friction: f64) -> Self {
        let angle = 0.5 * TAU / counts_per_turn;
        Self { hand, mechanics, counts_per_turn, friction, angle, speed: 0.0, count: 0, time: None }
    }

    /// A shaft that nobody touches.
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
        let hand = self.time.map_or(0.0, &self.hand);
        self.time = self.time.map(|time| time + seconds);
        let inertia = self.mechanics.inertia;
        let pushed = inertia * self.speed + (torque + hand) * seconds;
        let held = self.friction * seconds;
        let left = (pushed.abs() - held).max(0.0) * pushed.signum();
        self.speed = left / (inertia + self.mechanics.damping * seconds);
        self.angle += self.speed * seconds;
        let count = (self.angle * self.counts_per_turn / TAU).floor() as i32;
        let counts = count - std::mem::replace(&mut self.count, count);
        Motion { counts, angle: self.angle, speed: self.speed }
    }
}
