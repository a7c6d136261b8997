use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Canceller, Drag, Knots, Parts, Profile, Shape, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// Torque over angle: a table, which stays in flash.
static KNOTS: Knots<16> = Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-1.5, 1.5, 5.0)]);

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Parts {
        canceller: Some(Canceller::to(0.018)),
        drag: Some(Drag { damping: 0.0005, delay: 1 }),
        wall: Some(Wall::damped(2.0, 0.001, 1).behind(1.2)),
        profile: Some(Profile::of(&KNOTS, 1)),
        ..Parts::NONE
    }
    .sum(),
    latency: Latency::NONE,
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
