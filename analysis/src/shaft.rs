//! The shaft of a motor at a board's own bridge: it gets the motor's torque in each period of the modulation,
//! and moves in it.
//!
//! The mean over a period of the modulation is fine enough: within it the torque goes up and down around a
//! line by the ripple, which the bridge's resolution bounds. A mean over a period of the servo would not be:
//! the current loop sees the count and the back-EMF many times within that.

use std::f64::consts::TAU;

use haptic_servo::current::CurrentLoop;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

use crate::device::Energy;
use crate::disturbance::Disturbance;
use crate::hand::HandTrajectory;
use crate::lockstep::{PlantIo, SimulatedDevice};
use crate::missed::{Missed, Ticks};
use crate::simulation::SimulationError;

/// Largest deviation of a time from a whole number of steps, in steps, that counts as rounding.
const WHOLE: f64 = 1e-6;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShaftMotion {
    pub count: i32,
    /// Angle in rad.
    pub angle: f64,
    /// Speed in rad/s.
    pub speed: f64,
}

pub trait Shaft {
    /// A period of the servo begins; false if there are no more, as at the end of a recording.
    fn begin(&mut self) -> bool {
        true
    }

    /// Whether the reading of the next period but one of the servo fails; asked once in a period.
    fn reading_fails(&mut self) -> bool {
        false
    }

    /// Turns for a time in s with this mean torque of the motor in N m; returns the motion at the end.
    fn turn(&mut self, torque: f64, seconds: f64) -> ShaftMotion;
}

/// A shaft that is led, independent of the motor's torque: at constant speed to its position at the next
/// count.
#[derive(Clone, Debug)]
pub struct LedShaft {
    radians_per_count: f64,
    /// Periods of the modulation in one of the servo, and their length in s.
    updates: u16,
    step: f64,
    /// Positions in counts at the last count and at the next one.
    from: f64,
    to: f64,
    /// Periods of the modulation since the last count.
    update: u16,
}

impl LedShaft {
    /// At rest at a position in counts.
    pub fn new(position: f64, transducers: &Transducers, current_loop: &CurrentLoop) -> Self {
        Self {
            radians_per_count: TAU / transducers.counts_per_turn,
            updates: current_loop.updates(),
            step: current_loop.response().delay,
            from: position,
            to: position,
            update: 0,
        }
    }

    /// Leads it to this position in counts in the period that begins.
    pub fn lead_to(&mut self, position: f64) {
        (self.from, self.to, self.update) = (self.to, position, 0);
    }
}

impl Shaft for LedShaft {
    fn turn(&mut self, _: f64, _: f64) -> ShaftMotion {
        // A board that starts again has more updates until the next count, in which the shaft stands still.
        let is_moving = self.update < self.updates;
        self.update = (self.update + 1).min(self.updates);
        let way = self.to - self.from;
        let part = f64::from(self.update) / f64::from(self.updates);
        let position = if self.update == self.updates { self.to } else { self.from + part * way };
        let rate = if is_moving { way / (f64::from(self.updates) * self.step) } else { 0.0 };
        ShaftMotion {
            count: position.floor() as i64 as i32,
            angle: position * self.radians_per_count,
            speed: rate * self.radians_per_count,
        }
    }
}

/// A shaft that is led through recorded counts, one at each count of the servo.
#[derive(Clone, Debug)]
pub struct RecordedShaft<'a> {
    counts: std::slice::Iter<'a, i32>,
    width: CounterWidth,
    position: i64,
    led: LedShaft,
}

impl<'a> RecordedShaft<'a> {
    /// At rest at zero, in front of the first count.
    pub fn new(counts: &'a [i32], transducers: &Transducers, current_loop: &CurrentLoop) -> Self {
        let led = LedShaft::new(0.0, transducers, current_loop);
        Self { counts: counts.iter(), width: transducers.counter, position: 0, led }
    }
}

impl Shaft for RecordedShaft<'_> {
    fn begin(&mut self) -> bool {
        let Some(&count) = self.counts.next() else { return false };
        // A counter wraps: the change is the shorter way.
        let shift = self.width as u32;
        let way = (count.wrapping_sub(self.position as i32) << shift) >> shift;
        self.position += i64::from(way);
        self.led.lead_to(self.position as f64);
        true
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> ShaftMotion {
        self.led.turn(torque, seconds)
    }
}

/// The shaft of a scene's device, in a hand that follows a trajectory.
pub struct HandHeldShaft {
    device: SimulatedDevice,
    /// Which readings of the servo fail.
    failing: Ticks,
    step: f64,
    /// Time in s since the last whole step, and the integral of the motor's torque over it, in N m s.
    time: f64,
    impulse: f64,
}

impl HandHeldShaft {
    pub fn new(
        scene: &Scene,
        trajectory: HandTrajectory,
        transducers: &Transducers,
        current_loop: &CurrentLoop,
    ) -> Result<Self, SimulationError> {
        let step = current_loop.response().delay;
        let device = SimulatedDevice::on_shaft(scene, trajectory, transducers, step)?;
        let failing = Missed::None.ticks();
        Ok(Self { device, failing, step, time: 0.0, impulse: 0.0 })
    }

    /// The same with friction and cogging of its motor.
    pub fn with_disturbance(self, disturbance: Disturbance) -> Self {
        Self { device: self.device.with_disturbance(disturbance), ..self }
    }

    /// The same with readings of the encoder that fail, from the third on.
    pub fn failing(self, dropped: Missed) -> Self {
        let mut failing = dropped.ticks();
        let _ = failing.nth(1);
        Self { failing, ..self }
    }

    /// The hand lets go, or follows its trajectory.
    pub fn let_go(&mut self, let_go: bool) {
        self.device.let_go(let_go);
    }

    /// Energy that passed between hand and device so far.
    pub fn energy(&self) -> Energy {
        self.device.energy()
    }

    /// The device in the hand.
    pub const fn device(&self) -> &SimulatedDevice {
        &self.device
    }

    pub fn motion(&mut self) -> ShaftMotion {
        let motion = self.device.motion();
        // A device always has a count.
        let count = self.device.count().unwrap_or_default();
        ShaftMotion { count, angle: motion.position, speed: motion.velocity }
    }
}

impl Shaft for HandHeldShaft {
    fn reading_fails(&mut self) -> bool {
        self.failing.next().unwrap_or(false)
    }

    /// A part of a step, which occurs only when a board starts its timer, waits for the rest of it.
    fn turn(&mut self, torque: f64, seconds: f64) -> ShaftMotion {
        self.time += seconds;
        self.impulse += torque * seconds;
        let steps = (self.time / self.step + WHOLE).floor();
        if steps >= 1.0 {
            let mean = self.impulse / self.time;
            for _ in 0..steps as u32 {
                self.device.push(mean);
            }
            self.time = (self.time - steps * self.step).max(0.0);
            self.impulse = mean * self.time;
        }
        self.motion()
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::current::{B_G431B_ESC1, Drive, Motor, Supply, Winding};
    use haptic_servo::environment::Wall;
    use haptic_servo::scene::{Coupling, Device, Latency};

    use super::*;

    const PERIOD: f64 = 1e-3;

    const TRANSDUCERS: Transducers = Transducers {
        counts_per_turn: 61_440.0,
        counter: CounterWidth::Bits16,
        full_scale_torque: 1.0,
        largest_speed: 25.0,
    };

    /// A current loop with 40 periods of the modulation in a period of the servo.
    fn current_loop() -> CurrentLoop {
        let motor = Motor {
            winding: Winding::Brushed,
            resistance: 0.6,
            inductance: 0.12e-3,
            torque_constant: 0.29,
        };
        let supply = Supply::sinking(23.5, 25.2);
        let drive = Drive { motor, supply, bandwidth: 2000.0, largest_temperature: 80.0 };
        CurrentLoop::design(&drive, &B_G431B_ESC1, &TRANSDUCERS, PERIOD).unwrap()
    }

    /// The motion after this number of periods of the modulation.
    fn turned(shaft: &mut dyn Shaft, periods: u32) -> ShaftMotion {
        (0..periods).map(|_| shaft.turn(0.0, PERIOD / 40.0)).last().unwrap()
    }

    #[test]
    fn a_recording_is_at_each_count_when_the_servo_reads_it() {
        let counts = [3, 50, 32_760, -32_760, -32_768, 32_767];
        let mut shaft = RecordedShaft::new(&counts, &TRANSDUCERS, &current_loop());
        // At the counter's overflow the change is the shorter way.
        for (count, position) in counts.into_iter().zip([3, 50, 32_760, 32_776, 32_768, 32_767]) {
            assert!(shaft.begin());
            let end = turned(&mut shaft, 40);
            assert_eq!(end.count as i16, count as i16);
            let angle = f64::from(position) * TAU / TRANSDUCERS.counts_per_turn;
            assert!(end.count == position && (end.angle - angle).abs() < 1e-12, "{end:?}");
        }
        assert!(!shaft.begin());
        // A board that starts again has more updates than a period's.
        let (end, later) = (turned(&mut shaft, 1), turned(&mut shaft, 7));
        assert_eq!((end.speed, end), (0.0, later));
    }

    #[test]
    fn a_led_shaft_moves_steadily_in_between() {
        let mut shaft = LedShaft::new(100.0, &TRANSDUCERS, &current_loop());
        shaft.lead_to(180.0);
        let speed = 80.0 / PERIOD * TAU / TRANSDUCERS.counts_per_turn;
        for update in 1..=40 {
            let motion = turned(&mut shaft, 1);
            assert_eq!(motion.count, 100 + 2 * update);
            assert!((motion.speed / speed - 1.0).abs() < 1e-12, "{motion:?}");
        }
        assert_eq!(turned(&mut shaft, 1).speed, 0.0);
    }

    /// The torque acts at once, independent of the scene's latency: `m v' = u - b v`. Parts of a period of
    /// the modulation wait until they make a whole one.
    #[test]
    fn a_device_that_nobody_holds_is_moved_by_the_motor_s_torque() {
        let (inertia, damping, torque) = (2.2e-5, 0.022, 0.1);
        let wall = Wall::spring(20.0, 0).behind(0.0);
        let scene = Scene {
            coupling: Coupling::Matched,
            latency: Latency::sampled(40, 8e-5, PERIOD),
            ..Scene::of(Device::damped(inertia, damping), PERIOD, wall.alone())
        };
        let hand = HandTrajectory::push_and_let_go();
        let mut shaft = HandHeldShaft::new(&scene, hand, &TRANSDUCERS, &current_loop()).unwrap();
        shaft.let_go(true);
        let step = PERIOD / 40.0;
        let speed = |time: f64| torque / damping * (1.0 - (-damping / inertia * time).exp());
        for (seconds, steps) in [(step, 1), (0.4 * step, 1), (0.6 * step, 2), (3.0 * step, 5)] {
            let motion = shaft.turn(torque, seconds);
            let expected = speed(f64::from(steps) * step);
            assert!((motion.speed - expected).abs() < 1e-9, "{motion:?} in place of {expected}");
        }
    }
}
