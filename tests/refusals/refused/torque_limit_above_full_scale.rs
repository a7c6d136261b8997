//! More torque than the motor has.
use firmware::certificate::Certified;
use firmware::environment::DelayedSpring;
use firmware::scene::Scene;
use refusals::TRANSDUCERS;

const SCENE: Scene<DelayedSpring<1>> = Scene { torque_limit: Some(3.0), ..refusals::SCENE };
const CERTIFIED: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
