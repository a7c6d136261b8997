//! More torque than the motor has.
use haptic_servo::certificate::Certified;
use haptic_servo::scene::Scene;
use refusals::TRANSDUCERS;

const SCENE: Scene = Scene { torque_limit: Some(3.0), ..refusals::SCENE };
const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
