//! A sign that belongs into the wiring.
use firmware::environment::DelayedSpring;
use firmware::servo::Transducers;
use refusals::*;

const TRANSDUCERS: Transducers = Transducers { full_scale_torque: -2.0, ..refusals::TRANSDUCERS };

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
