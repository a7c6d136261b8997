//! What a motor turns: the paddle in a hand, a shaft of its own, or what a test leads.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

use virtual_board::device::{Device, Motion};

use haptic_servo::scene::Device as Mechanics;

use super::{bridge_wall, brushless_wall};

/// Damping of a hand in N m s/rad on the shaft, which keeps its speed within the limit.
const HAND_DAMPING: f64 = 0.005;

/// A shaft with its encoder, at rest half a count above zero.
pub struct Shaft {
    /// Angle in rad.
    pub angle: f64,
    /// Speed in rad/s.
    pub speed: f64,
    /// Seconds since the motor was first switched on, at the beginning of the period.
    pub time: Option<f64>,
    counts_per_turn: f64,
    count: i32,
}

/// A shaft that a function moves, by the motor's mean torque in N m over a time in s.
pub struct Driven<F> {
    shaft: Shaft,
    drive: F,
}

impl<F: FnMut(&mut Shaft, f64, f64) + Send + 'static> Driven<F> {
    /// With an encoder of these counts.
    pub fn new(counts_per_turn: f64, drive: F) -> Self {
        let angle = 0.5 * TAU / counts_per_turn;
        Self { shaft: Shaft { angle, speed: 0.0, time: None, counts_per_turn, count: 0 }, drive }
    }
}

impl<F: FnMut(&mut Shaft, f64, f64)> Device for Driven<F> {
    fn sample(&mut self, _: Option<u16>, is_on: bool) -> i32 {
        if is_on {
            self.shaft.time.get_or_insert(0.0);
        }
        0
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        let Self { shaft, drive } = self;
        drive(shaft, torque, seconds);
        shaft.time = shaft.time.map(|time| time + seconds);
        let count = (shaft.angle * shaft.counts_per_turn / TAU).floor() as i32;
        let counts = count - std::mem::replace(&mut shaft.count, count);
        Motion { counts, angle: shaft.angle, speed: shaft.speed }
    }
}

/// A device with Coulomb friction in N m, in a hand that pushes with a torque: its speed at the end, by the
/// torques and the friction at it, which may hold it; and with it the angle.
fn in_hand(
    mechanics: Mechanics,
    friction: f64,
    hand: impl Fn(Option<f64>) -> f64 + Send + 'static,
) -> impl FnMut(&mut Shaft, f64, f64) + Send + 'static {
    move |shaft, torque, seconds| {
        let inertia = mechanics.inertia;
        let pushed = inertia * shaft.speed + (torque + hand(shaft.time)) * seconds;
        let left = (pushed.abs() - friction * seconds).max(0.0) * pushed.signum();
        shaft.speed = left / (inertia + mechanics.damping * seconds);
        shaft.angle += shaft.speed * seconds;
    }
}

/// The paddle of `bridge_wall` with friction in N m, in a hand with this torque by the seconds since the
/// motor was first switched on.
pub fn paddle(
    hand: impl Fn(f64) -> f64 + Send + 'static,
    friction: f64,
) -> impl Device + Send + 'static {
    let hand = move |time: Option<f64>| time.map_or(0.0, &hand);
    let device = in_hand(bridge_wall::SCENE.device, friction, hand);
    Driven::new(bridge_wall::TRANSDUCERS.counts_per_turn, device)
}

/// A paddle that nobody touches.
pub fn still() -> impl Device + Send + 'static {
    paddle(|_| 0.0, 0.0)
}

/// The shaft of `brushless_wall` with some friction, in a hand with this torque, from the first moment on.
pub fn shaft(torque: Arc<Mutex<f64>>) -> impl Device + Send + 'static {
    let counts_per_turn = brushless_wall::TRANSDUCERS.counts_per_turn;
    shaft_of(brushless_wall::SCENE.device, counts_per_turn, torque)
}

/// The same of another device and encoder.
pub fn shaft_of(
    device: Mechanics,
    counts_per_turn: f64,
    torque: Arc<Mutex<f64>>,
) -> impl Device + Send + 'static {
    let mechanics = Mechanics { damping: HAND_DAMPING, ..device };
    let device = in_hand(mechanics, 0.002, move |_| *torque.lock().unwrap());
    Driven::new(counts_per_turn, device)
}
