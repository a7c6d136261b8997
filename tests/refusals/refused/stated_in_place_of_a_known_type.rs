//! A statement about a type that the certificate knows by itself.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DelayedSpring, StatedBound, StatedModel};
use haptic_servo::scene::Scene;
use refusals::scene;

const NOTHING: StatedModel =
    StatedModel::Bounded { delay: 1, bound: StatedBound { index: 0.0, gain: 0.0 } };

const CERTIFIED: Certified<Scene<DelayedSpring<1>>> =
    scene(DelayedSpring { stiffness: 1000.0 }).certified_as(NOTHING);

fn main() {
    let _ = CERTIFIED;
}
