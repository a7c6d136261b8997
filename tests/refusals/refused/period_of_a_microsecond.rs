//! A period that no board finishes a tick in.
use firmware::certificate::Certified;
use firmware::environment::DelayedSpring;
use firmware::scene::{Scene, Timing};
use refusals::TRANSDUCERS;

const SCENE: Scene<DelayedSpring<1>> =
    Scene { timing: Timing { period: 1e-6, worst_period: None }, ..refusals::SCENE };
const CERTIFIED: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
