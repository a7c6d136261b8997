//! The paper's wall, felt on one side.
use firmware::certificate::Certified;
use firmware::environment::{DamperWall, OneSided};
use firmware::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<OneSided<DamperWall<1>>>> =
    scene(OneSided { face: 0.1, wall: DamperWall { stiffness: 22.0, damping: 0.01 } }).certified();

fn main() {
    let _ = CERTIFIED;
}
