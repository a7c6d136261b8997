//! A spring just below the line, whose stiffness is rounded onto it.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DelayedSpring;
use haptic_servo::number::Format;
use haptic_servo::scene::Scene;
use refusals::scene;

const AS_WRITTEN: Certified<Scene<DelayedSpring<1>>> =
    scene(DelayedSpring { stiffness: 43.999999 }).certified();
const AS_IT_RUNS: Certified<Scene<DelayedSpring<1>>> = AS_WRITTEN.certified_in(Format::F32);

fn main() {
    let _ = AS_IT_RUNS;
}
