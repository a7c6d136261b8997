use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.0215) },
    timing: Timing { period: 0.0001, worst_period: None },
    coupling: Coupling::Matched,
    environment: Wall::spring(20.0, 1).alone(),
    latency: Latency {
        output_delay: TimeRange::exactly(2.5e-5),
        actuator_lag: TimeRange::exactly(7.957747154594768e-5),
        actuator_updates: 4,
        ..Latency::NONE
    },
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
