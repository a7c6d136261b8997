use haptic_servo::certificate::Certified;
use haptic_servo::environment::{FilteredWall, FreeModeWall, OneSided};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// The environment that the hand feels.
pub type Environment = FreeModeWall<OneSided<FilteredWall<2>>>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.021) },
    timing: Timing { period: 0.001, worst_period: Some(0.0011) },
    coupling: Coupling::Spring { stiffness: 38.0 },
    environment: FreeModeWall {
        residual: 0.018,
        wall: OneSided {
            face: 0.3,
            wall: FilteredWall { stiffness: 3.0, damping: 0.001, filter: 0.25 },
        },
    },
    latency: Latency::NONE,
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();
