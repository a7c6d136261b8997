//! A scene whose torques come 10 microseconds after their counts, on a board that puts them out after 20.
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::scene::Scene;
use haptic_servo::servo::AtPhase;
use refusals::at_phase;

const CERTIFIED: Certified<Scene> = at_phase(1e-5).certified();
const _: TimingChecked<Scene, AtPhase<20_000>> = CERTIFIED.timing_checked::<AtPhase<20_000>>();

fn main() {}
