//! A device that would start by itself, and nobody says why it may.
use firmware::servo_loop::Options;
use firmware::environment::DelayedSpring;
use refusals::*;

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
    options: Options::DEFAULT.armed_at_power_on(" "),
}
