//! A servo that never comes to the next sample.
use firmware::certificate::Certified;
use firmware::environment::DelayedSpring;
use firmware::scene::{Scene, Timing};

const SCENE: Scene<DelayedSpring<1>> =
    Scene { timing: Timing { period: 0.0, worst_period: None }, ..refusals::SCENE };
const CERTIFIED: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();

fn main() {
    let _ = CERTIFIED;
}
