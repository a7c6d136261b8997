//! A spring just below the line, whose stiffness is rounded onto it.
use firmware::certificate::Certified;
use firmware::environment::*;
use firmware::number::Format;
use firmware::scene::{Coupling, Device, Scene, Timing};

const SCENE: Scene<DelayedSpring<1>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: DelayedSpring { stiffness: 43.999999 },
    torque_limit: None,
};
const AS_WRITTEN: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();
const AS_IT_RUNS: Certified<Scene<DelayedSpring<1>>> = AS_WRITTEN.certified_in(Format::F32);

fn main() {
    let _ = AS_IT_RUNS;
}
