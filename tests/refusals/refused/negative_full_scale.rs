//! A sign that belongs into the wiring.
use haptic_servo::environment::DelayedSpring;
use haptic_servo::servo::Transducers;
use refusals::*;

const TRANSDUCERS: Transducers = Transducers { full_scale_torque: -2.0, ..refusals::TRANSDUCERS };

haptic_servo::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
