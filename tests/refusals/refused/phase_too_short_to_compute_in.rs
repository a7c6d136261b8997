//! A torque that would be put out before any board had computed it.
use firmware::certificate::{Certified, TimingChecked};
use firmware::scene::Scene;
use firmware::servo::AtPhase;
use refusals::{UndelayedWall, at_phase};

const CERTIFIED: Certified<Scene<UndelayedWall>> = at_phase(2e-6).certified();
const TIMED: TimingChecked<Scene<UndelayedWall>, AtPhase<2_000>> =
    CERTIFIED.timing_checked::<AtPhase<2_000>>();

fn main() {
    let _ = TIMED;
}
