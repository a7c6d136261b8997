use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Canceller, Parts, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Matched,
    environment: Parts {
        canceller: Some(Canceller::to(0.004)),
        wall: Some(Wall::damped(22.0, 0.01, 0).behind(0.0)),
        ..Parts::NONE
    }
    .sum(),
    latency: Latency {
        output_delay: TimeRange::exactly(1e-5),
        actuator_lag: TimeRange::exactly(5.3e-5),
        output_jitter: 1e-6,
        ..Latency::NONE
    },
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
