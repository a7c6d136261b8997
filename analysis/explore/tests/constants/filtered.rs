use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Canceller, Parts, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.021) },
    timing: Timing { period: 0.001, worst_period: Some(0.0011) },
    coupling: Coupling::Spring { stiffness: 38.0 },
    environment: Parts {
        canceller: Some(Canceller::to(0.018)),
        wall: Some(Wall::damped(3.0, 0.001, 2).filtered(0.25).behind(0.3)),
        ..Parts::NONE
    }
    .sum(),
    latency: Latency::NONE,
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
