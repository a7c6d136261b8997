//! A spring that pulls away from its rest position.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DelayedSpring<0>>> =
    scene(DelayedSpring { stiffness: -22.0 }).certified();

fn main() {
    let _ = CERTIFIED;
}
