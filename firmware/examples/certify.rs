//! A certificate as a constant, and the refusal of a scene.

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// A spring of 22 N m/rad, one sample late at 1 kHz, on a device with 0.022 N m s/rad of damping.
const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::spring(22.0, 1).alone(),
    latency: Latency::NONE,
    torque_limit: None,
};

/// Proved while this compiles: a scene that could oscillate in a hand is a compile error here.
const CERTIFIED: Certified<Scene> = SCENE.certified();

fn main() {
    let assessment = CERTIFIED.assessment();
    if let Some(alpha) = assessment.alpha_coupled {
        println!("certified: alpha = {:.4} N m s/rad", alpha.hi());
    }
    println!("           delta = {:.4} N m s/rad", assessment.delta.lo());
    let stiffer = Scene { environment: Wall::spring(220.0, 1).alone(), ..SCENE };
    match stiffer.certify() {
        Ok(_) => println!("certified"),
        Err(rejection) => println!("{rejection}"),
    }
}
