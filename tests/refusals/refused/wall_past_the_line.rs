//! The paper's wall with a little too much damping: alpha = 0.0225.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DamperWall;
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DamperWall<1>>> =
    scene(DamperWall { stiffness: 22.0, damping: 0.0115 }).certified();

fn main() {
    let _ = CERTIFIED;
}
