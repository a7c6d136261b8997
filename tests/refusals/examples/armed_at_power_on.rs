//! The same with a reason.
use haptic_servo::environment::DelayedSpring;
use haptic_servo::servo_loop::Options;
use refusals::*;

haptic_servo::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
    options: Options::DEFAULT.armed_at_power_on("a demonstration behind glass"),
}
