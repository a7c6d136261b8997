//! A wall without delay on a board whose timer latches each torque until the next tick.
use firmware::certificate::{Certified, TimingChecked};
use firmware::environment::DamperWall;
use firmware::scene::Scene;
use firmware::servo::Latched;
use refusals::scene;

const CERTIFIED: Certified<Scene<DamperWall<0>>> =
    scene(DamperWall { stiffness: 20.0, damping: 0.01 }).certified();
const TIMED: TimingChecked<Scene<DamperWall<0>>, Latched> = CERTIFIED.timing_checked::<Latched>();

fn main() {
    let _ = TIMED;
}
