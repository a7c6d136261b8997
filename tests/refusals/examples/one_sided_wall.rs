//! The paper's wall, felt on one side.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DamperWall, OneSided};
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<OneSided<DamperWall<1>>>> =
    scene(OneSided { face: 0.1, wall: DamperWall { stiffness: 22.0, damping: 0.01 } }).certified();

fn main() {
    let _ = CERTIFIED;
}
