//! A wall without delay on a board whose timer latches each torque until the next tick.
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::environment::Wall;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Latched;
use refusals::scene;

const CERTIFIED: Certified<Scene> = scene(Wall::damped(20.0, 0.01, 0).alone()).certified();
const _: TimingChecked<Scene, Latched> = CERTIFIED.timing_checked::<Latched>();

fn main() {}
