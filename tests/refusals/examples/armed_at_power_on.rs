//! The same with a reason.
use firmware::environment::DelayedSpring;
use firmware::servo_loop::Options;
use refusals::*;

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
    options: Options::DEFAULT.armed_at_power_on("a demonstration behind glass"),
}
