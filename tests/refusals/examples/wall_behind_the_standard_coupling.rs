//! The wall that is refused behind a stiffer coupling: at 2 delta / T it passes.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DamperWall;
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DamperWall<1>>> =
    scene(DamperWall { stiffness: 22.0, damping: 0.01 }).certified();

fn main() {
    let _ = CERTIFIED;
}
