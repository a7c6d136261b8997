//! The same wall one sample late: that is the sample which the latch takes.
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::environment::DamperWall;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Latched;
use refusals::scene;

const CERTIFIED: Certified<Scene<DamperWall<1>>> =
    scene(DamperWall { stiffness: 20.0, damping: 0.01 }).certified();
const TIMED: TimingChecked<Scene<DamperWall<1>>, Latched> = CERTIFIED.timing_checked::<Latched>();

fn main() {
    let _ = TIMED;
}
