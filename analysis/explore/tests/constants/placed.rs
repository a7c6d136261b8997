use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DamperWall, Placed};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// The environment that the hand feels.
pub type Environment = Placed<DamperWall<1>>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.0005, worst_period: None },
    coupling: Coupling::Spring { stiffness: 40.0 },
    environment: Placed { face: -0.125, wall: DamperWall { stiffness: 3.0, damping: 0.001 } },
    latency: Latency::NONE,
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();
