//! Cancels all but a little of the device's damping.
use firmware::certificate::Certified;
use firmware::environment::*;
use firmware::scene::{Coupling, Device, Scene, Timing};

const SCENE: Scene<FreeMode<0>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: FreeMode { residual: 0.001 },
    torque_limit: None,
};
const CERTIFIED: Certified<Scene<FreeMode<0>>> = SCENE.certified();

fn main() {
    let _ = CERTIFIED;
}
