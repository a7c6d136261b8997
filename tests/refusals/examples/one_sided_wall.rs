//! The paper's wall, felt on one side.
use firmware::certificate::Certified;
use firmware::environment::*;
use firmware::scene::{Coupling, Device, Scene, Timing};

const SCENE: Scene<OneSided<DamperWall<1>>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: OneSided { face: 0.1, wall: DamperWall { stiffness: 22.0, damping: 0.01 } },
    torque_limit: None,
};
const CERTIFIED: Certified<Scene<OneSided<DamperWall<1>>>> = SCENE.certified();

fn main() {
    let _ = CERTIFIED;
}
