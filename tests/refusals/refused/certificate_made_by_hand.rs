//! A certificate built by hand: its fields are private.
use haptic_servo::certificate::{Certified, assess};
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::Scene;
use refusals::scene;

const SCENE: Scene<DelayedSpring<1>> = scene(DelayedSpring { stiffness: 88.0 });

fn main() {
    let _ = Certified { scene: SCENE, assessment: assess(&SCENE.as_data()) };
}
