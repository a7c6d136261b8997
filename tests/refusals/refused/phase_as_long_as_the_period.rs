//! A torque that would be put out when the next one may be there already.
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::scene::Scene;
use haptic_servo::servo::AtPhase;
use refusals::{UndelayedWall, at_phase};

const CERTIFIED: Certified<Scene<UndelayedWall>> = at_phase(0.0009995).certified();
const TIMED: TimingChecked<Scene<UndelayedWall>, AtPhase<999_500>> =
    CERTIFIED.timing_checked::<AtPhase<999_500>>();

fn main() {
    let _ = TIMED;
}
