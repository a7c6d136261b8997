//! A knob with eleven modes that are selected while it runs, one sample late.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::{KNOB_MODES, Profile};
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
pub use paddle::TRANSDUCERS;

/// The scene, which starts with a freely turning knob. Every mode is certified.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Profile::of_modes(&KNOB_MODES, 1).alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate: a mode that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
}
