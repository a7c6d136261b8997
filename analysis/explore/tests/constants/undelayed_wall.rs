use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DamperWall, FreeModeWall, Matched, OneSided};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};

/// The environment that the hand feels.
pub type Environment = Matched<FreeModeWall<OneSided<DamperWall<0>>>, 0, 1>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Matched,
    environment: Matched {
        environment: FreeModeWall {
            residual: 0.004,
            wall: OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } },
        },
    },
    latency: Latency {
        output_delay: TimeRange::exactly(1e-5),
        actuator_lag: TimeRange::exactly(5.3e-5),
        output_jitter: 1e-6,
        ..Latency::NONE
    },
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();
