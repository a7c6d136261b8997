//! A spring just below the line, whose stiffness is rounded onto it.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::number::Format;
use haptic_servo::scene::Scene;
use refusals::scene;

const AS_WRITTEN: Certified<Scene> = scene(Wall::spring(43.999999, 1).alone()).certified();
const _: Certified<Scene> = AS_WRITTEN.certified_in(Format::F32);

fn main() {}
