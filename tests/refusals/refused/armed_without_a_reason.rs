//! A device that would arm itself at power-on, without a reason.
use haptic_servo::servo_loop::Options;
use haptic_servo::environment::DelayedSpring;
use refusals::*;

haptic_servo::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
    options: Options::DEFAULT.armed_at_power_on(" "),
}
