//! A device that would arm itself at power-on, without a reason.
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
