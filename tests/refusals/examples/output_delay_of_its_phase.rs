//! The same scene on a board that puts its torques out when it says.
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::scene::Scene;
use haptic_servo::servo::AtPhase;
use refusals::{UndelayedWall, at_phase};

const CERTIFIED: Certified<Scene<UndelayedWall>> = at_phase(1e-5).certified();
const TIMED: TimingChecked<Scene<UndelayedWall>, AtPhase<10_000>> =
    CERTIFIED.timing_checked::<AtPhase<10_000>>();

fn main() {
    let _ = TIMED;
}
