//! An encoder that counts nothing.
use haptic_servo::environment::DelayedSpring;
use haptic_servo::servo::Transducers;
use refusals::*;

const TRANSDUCERS: Transducers = Transducers { counts_per_turn: 0.0, ..refusals::TRANSDUCERS };

haptic_servo::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
