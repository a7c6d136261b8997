//! The wall of `brushless_wall` with a motor that is aligned by its encoder's index: after a reset, turn the
//! handle past the index; no field moves the handle.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod brushless_shaft;

pub use brushless_shaft::{DRIVE, SCENE, TRANSDUCERS};
use haptic_servo::certificate::Certified;
use haptic_servo::current::{CurrentLoop, EncoderIndex, IndexOffset};
use haptic_servo::scene::Scene;

/// For one motor, with its wires in this order and the encoder in this position on its shaft. With a wrong
/// offset, a motor's torque is too small or has the wrong sign. `haptic tune --align` finds yours.
pub const OFFSET: IndexOffset = IndexOffset { counts: 812, is_reversed: false };

/// The current loop, aligned by the index.
pub const CURRENT_LOOP: CurrentLoop =
    brushless_shaft::CURRENT_LOOP.with_index(EncoderIndex { offset: Some(OFFSET) });

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    bridge: CURRENT_LOOP,
}
