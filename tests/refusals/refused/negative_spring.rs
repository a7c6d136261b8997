//! A spring that pulls away from its rest position.
use firmware::certificate::Certified;
use firmware::environment::*;
use firmware::scene::{Coupling, Device, Scene, Timing};

const SCENE: Scene<DelayedSpring<0>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: DelayedSpring { stiffness: -22.0 },
    torque_limit: None,
};
const CERTIFIED: Certified<Scene<DelayedSpring<0>>> = SCENE.certified();

fn main() {
    let _ = CERTIFIED;
}
