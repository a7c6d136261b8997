//! A wall without delay on a board whose timer latches each torque until the next tick.
use firmware::certificate::{Certified, Timed};
use firmware::environment::DamperWall;
use firmware::scene::{Coupling, Device, Scene, Timing};
use firmware::servo::Latched;

const SCENE: Scene<DamperWall<0>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: DamperWall { stiffness: 20.0, damping: 0.01 },
    torque_limit: None,
};
const CERTIFIED: Certified<Scene<DamperWall<0>>> = SCENE.certified();
const TIMED: Timed<Scene<DamperWall<0>>, Latched> = CERTIFIED.timed::<Latched>();

fn main() {
    let _ = TIMED;
}
