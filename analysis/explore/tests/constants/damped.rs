use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DampedProfile, Knots, Profile, Shape};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// The environment that the hand feels.
pub type Environment = DampedProfile<16, 1>;

/// Torque over angle: a table, which stays in flash.
static KNOTS: Knots<16> = Knots::of(&[Shape::Detents { count: 24, torque: 0.05, centre: 0.01 }]);

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: DampedProfile {
        profile: Profile { torque: 0.03, count: 12.0, ..Profile::of(&KNOTS) },
        damping: 0.002,
    },
    latency: Latency::NONE,
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();
