//! The same, felt on one side only and judged by the nonlinear bound.
use firmware::certificate::Certified;
use firmware::environment::{DamperWall, OneSided};
use firmware::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<OneSided<DamperWall<1>>>> =
    scene(OneSided { face: 0.1, wall: DamperWall { stiffness: 22.0, damping: 0.0115 } })
        .certified();

fn main() {
    let _ = CERTIFIED;
}
