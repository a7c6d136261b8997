//! Certified as long as its torque is never limited, which a board does when it fades in.

use firmware::certificate::{Certified, Timed};
use firmware::environment::DelayedSpring;
use firmware::scene::{Coupling, Device, Scene, Timing};
use firmware::servo::Latched;

const SCENE: Scene<DelayedSpring<2>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 33.0 },
    environment: DelayedSpring { stiffness: 15.0 },
    torque_limit: None,
};
const CERTIFIED: Certified<Scene<DelayedSpring<2>>> = SCENE.certified();
const TIMED: Timed<Scene<DelayedSpring<2>>, Latched> = CERTIFIED.timed::<Latched>();

fn main() {
    let _ = TIMED;
}
