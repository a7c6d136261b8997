use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Knots, Profile, Shape};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// Torque over angle: a table, which stays in flash.
static KNOTS: Knots<32> = Knots::of(&[
    Shape::detents(24, 0.05).snap(0.75),
    Shape::Detents { count: 8, torque: 0.01, centre: 0.01 },
    Shape::end_stops(-2.0, 2.0, 9.0),
]);

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Profile {
        torque: 0.03,
        count: 12.0,
        damping: Some(0.002),
        ..Profile::of(&KNOTS, 1)
    }
    .alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
