//! The wall of `brushless_wall` with a motor that is aligned by its encoder's index: after a reset the handle is
//! turned past it, and no field moves the handle.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod brushless_shaft;

pub use brushless_shaft::{DRIVE, Environment, Fixed, SCENE, TRANSDUCERS};
use haptic_servo::certificate::Certified;
use haptic_servo::current::{CurrentLoop, EncoderIndex, IndexOffset};
use haptic_servo::scene::Scene;

/// Of one motor, its wires in this order, and the encoder as it sits on its shaft: with another offset than its
/// own, the torque of a motor is less, or has the wrong sign. `haptic tune --align` finds yours.
pub const OFFSET: IndexOffset = IndexOffset { counts: 812, is_reversed: false };

/// The current loop, aligned by the index.
pub const CURRENT_LOOP: CurrentLoop =
    brushless_shaft::CURRENT_LOOP.with_index(EncoderIndex { offset: Some(OFFSET) });

/// Its certificate: a scene that could oscillate in a hand stops the compiler here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE: Environment,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: Fixed,
    bridge: CURRENT_LOOP,
}
