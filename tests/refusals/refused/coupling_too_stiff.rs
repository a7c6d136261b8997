//! The paper's wall behind ten times the standard coupling.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DamperWall;
use haptic_servo::scene::{Coupling, Scene};
use refusals::scene;

const SCENE: Scene<DamperWall<1>> = Scene {
    coupling: Coupling::Spring { stiffness: 440.0 },
    ..scene(DamperWall { stiffness: 22.0, damping: 0.01 })
};
const CERTIFIED: Certified<Scene<DamperWall<1>>> = SCENE.certified();

fn main() {
    let _ = CERTIFIED;
}
