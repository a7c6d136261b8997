use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DamperWall, OneSided};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// The environment that the hand feels.
pub type Environment = OneSided<DamperWall<1>>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } },
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();
