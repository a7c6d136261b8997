//! A counter of 16 bits wraps unseen between two ticks.
use haptic_servo::environment::DelayedSpring;
use haptic_servo::servo::Transducers;
use refusals::*;

const TRANSDUCERS: Transducers = Transducers { largest_speed: 1e4, ..refusals::TRANSDUCERS };

haptic_servo::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
