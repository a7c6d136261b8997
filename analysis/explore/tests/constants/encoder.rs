use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Knots, Profile, Shape};
use haptic_servo::scene::{Coupling, Device, EncoderReading, Latency, Scene, TimeRange, Timing};

/// Torque over angle: a table, which stays in flash.
static KNOTS: Knots<16> = Knots::of(&[Shape::detents(8, 0.02)]);

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Rigid,
    environment: Profile::of(&KNOTS, 0).alone(),
    latency: Latency {
        output_delay: TimeRange::exactly(6.500000000000001e-5),
        count_jitter: 5e-5,
        encoder: &EncoderReading {
            age: TimeRange::between(1e-5, 0.00011),
            linearity: 0.028,
            noise: 2.0,
            friction: 0.001,
            dropped: 1,
            ..EncoderReading::IDEAL
        },
        ..Latency::NONE
    },
    torque_limit: Some(1.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
