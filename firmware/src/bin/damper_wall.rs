//! A one-sided wall of spring and damper, one sample late: the paper's second example (equations 24 to 27),
//! with the paper's numbers.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
pub use paddle::TRANSDUCERS;

/// The scene.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::damped(22.0, 0.01, 1).behind(0.0).alone(),
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
