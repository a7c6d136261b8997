//! A statement about a type that the certificate knows by itself.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::{StatedBound, StatedModel, Wall};
use haptic_servo::scene::Scene;
use refusals::scene;

const NOTHING: StatedModel =
    StatedModel::Bounded { delay: 1, bound: StatedBound { index: 0.0, gain: 0.0 } };

const _: Certified<Scene> = scene(Wall::spring(1000.0, 1).alone()).certified_as(NOTHING);

fn main() {}
