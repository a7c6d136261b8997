//! A knob with 24 detents per turn between two end stops, one sample late.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Knots, Profile, Shape};
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
pub use paddle::TRANSDUCERS;

/// Ten detents in each direction, and the end stops: a table of one detent, in flash.
static KNOTS: Knots<16> =
    Knots::of(&[Shape::detents(24, 0.05), Shape::end_stops(-2.618, 2.618, 15.0)]);

/// The scene.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Profile::of(&KNOTS, 1).alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
}
