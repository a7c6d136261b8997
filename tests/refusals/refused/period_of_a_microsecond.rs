//! A period that no board finishes a tick in.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::{Scene, Timing};
use refusals::TRANSDUCERS;

const SCENE: Scene<DelayedSpring<1>> =
    Scene { timing: Timing { period: 1e-6, worst_period: None }, ..refusals::SCENE };
const CERTIFIED: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
