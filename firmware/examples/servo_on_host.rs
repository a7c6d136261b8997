//! The servo of a board on the host, with a simulated device: the same type, and the same bits.

use core::f64::consts::TAU;

use haptic_servo::certificate::Certified;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{BuildError, Output, Servo, Transducers};

const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::damped(22.0, 0.01, 1).behind(0.1).alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

const CERTIFIED: Certified<Scene> = SCENE.certified();

const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};

/// The device of the scene in steps of 10 microseconds, with its encoder and its motor.
#[derive(Default)]
struct SimulatedDevice {
    angle: f64,
    speed: f64,
}

impl SimulatedDevice {
    fn count(&self) -> i32 {
        (self.angle / TAU * TRANSDUCERS.counts_per_turn).floor() as i32
    }

    fn turn(&mut self, code: DacCode, hand: f64) {
        const STEPS: u32 = 100;
        let Device { inertia, damping, .. } = SCENE.device;
        let step = SCENE.timing.period / f64::from(STEPS);
        let full_scale = f64::from(DacCode::CODES_TO_FULL_SCALE);
        let motor = f64::from(code.offset()) / full_scale * TRANSDUCERS.full_scale_torque;
        for _ in 0..STEPS {
            self.speed += (motor + hand - damping * self.speed) / inertia * step;
            self.angle += self.speed * step;
        }
    }
}

fn main() -> Result<(), BuildError> {
    let mut servo: Servo<_, f32> = Servo::new(&CERTIFIED, &TRANSDUCERS)?;
    let mut device = SimulatedDevice::default();
    println!("ms   count    code   limited by");
    for tick in 0..=100 {
        let count = device.count();
        let Output { code, limit } = servo.tick(RawCount::from(count));
        if tick % 10 == 0 {
            println!("{tick:3}   {count:5}   {:5}   {}", code.get(), limit.as_str());
        }
        // A hand pushes into the wall, harder, and lets go.
        let hand = [0.1, 0.6, 1.2, 0.0][(tick / 25).min(3)];
        device.turn(code, hand);
    }
    Ok(())
}
