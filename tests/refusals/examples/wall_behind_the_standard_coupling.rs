//! The wall that is refused behind a stiffer coupling: at 2 delta / T it passes.
use firmware::certificate::Certified;
use firmware::environment::DamperWall;
use firmware::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DamperWall<1>>> =
    scene(DamperWall { stiffness: 22.0, damping: 0.01 }).certified();

fn main() {
    let _ = CERTIFIED;
}
