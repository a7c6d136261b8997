//! A certificate built by hand: its fields are private.
use haptic_servo::certificate::{Certified, assess};
use haptic_servo::environment::Wall;
use haptic_servo::scene::Scene;
use refusals::scene;

const SCENE: Scene = scene(Wall::spring(88.0, 1).alone());

fn main() {
    let _ = Certified { scene: SCENE, assessment: assess(&SCENE) };
}
