//! Only the certificate, for your own control loop: the loop computes in its own way, and takes its numbers
//! from a certified constant.
//!
//! The certificate is about a law and not about code. The loop must compute this law: here a spring that is
//! one sample late, behind a virtual coupling, with a limited torque, in `f32`.

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// The loop's law for the certificate.
pub const SPRING: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::spring(20.0, 1).alone(),
    latency: Latency::NONE,
    torque_limit: Some(0.3),
};

/// Certified with the numbers rounded to the loop's `f32`. The loop takes its numbers only from here, so that
/// no number can change without a certificate.
pub const CERTIFIED: Certified<Scene> = SPRING.certified().certified_in(Format::F32);

const STIFFNESS: f32 = match CERTIFIED.scene().environment.wall() {
    Some(wall) => wall.stiffness as f32,
    None => panic!("this loop has a spring"),
};
const COMPLIANCE: f32 = match CERTIFIED.scene().coupling {
    Coupling::Spring { stiffness } => (1.0 / stiffness) as f32,
    _ => panic!("this loop has a coupling that is a spring"),
};
const LIMIT: f32 = match CERTIFIED.scene().torque_limit {
    Some(limit) => limit as f32,
    None => f32::INFINITY,
};

/// Your own control loop, without any code of the library.
#[derive(Default)]
pub struct ControlLoop {
    /// Position of the spring's end behind the coupling in the previous sample, in rad.
    late: f32,
}

impl ControlLoop {
    /// The motor's torque in N m for this period.
    pub fn update(&mut self, angle: f32) -> f32 {
        let force = (STIFFNESS * self.late).clamp(-LIMIT, LIMIT);
        self.late = angle - force * COMPLIANCE;
        -force
    }
}

/// The device of the scene, in steps of 10 microseconds.
#[derive(Default)]
struct SimulatedDevice {
    angle: f64,
    speed: f64,
}

impl SimulatedDevice {
    fn turn(&mut self, torque: f64) {
        const STEPS: u32 = 100;
        let Device { inertia, damping, .. } = SPRING.device;
        let step = SPRING.timing.period / f64::from(STEPS);
        for _ in 0..STEPS {
            self.speed += (torque - damping * self.speed) / inertia * step;
            self.angle += self.speed * step;
        }
    }
}

/// Runs the loop against the device.
pub fn main() {
    let (mut servo, mut device) = (ControlLoop::default(), SimulatedDevice::default());
    println!("ms   angle/rad   torque/(N m)");
    for tick in 1..=60 {
        let torque = servo.update(device.angle as f32);
        if tick % 10 == 0 {
            println!("{tick:2}   {:9.4}   {torque:12.4}", device.angle);
        }
        // A hand pushes for 30 ms and lets go.
        let hand = if tick <= 30 { 0.25 } else { 0.0 };
        device.turn(f64::from(torque) + hand);
    }
}
