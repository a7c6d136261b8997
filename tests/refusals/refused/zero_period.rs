//! A servo that never comes to the next sample.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::{Scene, Timing};

const SCENE: Scene<DelayedSpring<1>> =
    Scene { timing: Timing { period: 0.0, worst_period: None }, ..refusals::SCENE };
const CERTIFIED: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();

fn main() {
    let _ = CERTIFIED;
}
