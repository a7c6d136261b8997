//! A wall on a motor board with a brushless motor; the handle is on the motor's shaft. The motor is aligned
//! after each reset, on request: `haptic tune --align --arm`.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod brushless_shaft;

pub use brushless_shaft::{CURRENT_LOOP, DRIVE, SCENE, TRANSDUCERS};
use haptic_servo::certificate::Certified;
use haptic_servo::scene::Scene;

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    bridge: CURRENT_LOOP,
}
