//! The same wall one sample late: that is the sample which the latch takes.
use firmware::certificate::{Certified, TimingChecked};
use firmware::environment::DamperWall;
use firmware::scene::Scene;
use firmware::servo::Latched;
use refusals::scene;

const CERTIFIED: Certified<Scene<DamperWall<1>>> =
    scene(DamperWall { stiffness: 20.0, damping: 0.01 }).certified();
const TIMED: TimingChecked<Scene<DamperWall<1>>, Latched> = CERTIFIED.timing_checked::<Latched>();

fn main() {
    let _ = TIMED;
}
