use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.0005, worst_period: None },
    coupling: Coupling::Matched,
    environment: Wall::damped(3.0, 0.001, 1).placed(-0.125).alone(),
    latency: Latency {
        output_delay: TimeRange::exactly(6e-6),
        actuator_response: TimeRange::between(2e-5, 0.00025),
        ..Latency::NONE
    },
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
