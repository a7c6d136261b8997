//! Certified as long as its torque is never limited, which a board does when it fades in.
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::{Coupling, Scene};
use haptic_servo::servo::Latched;
use refusals::scene;

const SCENE: Scene<DelayedSpring<2>> = Scene {
    coupling: Coupling::Spring { stiffness: 33.0 },
    ..scene(DelayedSpring { stiffness: 15.0 })
};
const CERTIFIED: Certified<Scene<DelayedSpring<2>>> = SCENE.certified();
const TIMED: TimingChecked<Scene<DelayedSpring<2>>, Latched> = CERTIFIED.timing_checked::<Latched>();

fn main() {
    let _ = TIMED;
}
