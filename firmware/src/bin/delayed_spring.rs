//! A spring with one sample of delay: the paper's first example (equations 20 and 21), with the paper's
//! numbers.
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
    environment: Wall::spring(22.0, 1).alone(),
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
