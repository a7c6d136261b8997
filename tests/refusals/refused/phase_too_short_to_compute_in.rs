//! A torque that would be put out before any board had computed it.
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::scene::Scene;
use haptic_servo::servo::AtPhase;
use refusals::{UndelayedWall, at_phase};

const CERTIFIED: Certified<Scene<UndelayedWall>> = at_phase(2e-6).certified();
const TIMED: TimingChecked<Scene<UndelayedWall>, AtPhase<2_000>> =
    CERTIFIED.timing_checked::<AtPhase<2_000>>();

fn main() {
    let _ = TIMED;
}
