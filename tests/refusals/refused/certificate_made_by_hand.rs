//! A certificate that nobody earned: its fields are private.
use firmware::certificate::{Certified, assess};
use firmware::environment::DelayedSpring;
use firmware::scene::{Coupling, Device, Scene, Timing};

const SCENE: Scene<DelayedSpring<1>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: DelayedSpring { stiffness: 88.0 },
    torque_limit: None,
};

fn main() {
    let _ = Certified { scene: SCENE, assessment: assess(&SCENE.as_data()) };
}
