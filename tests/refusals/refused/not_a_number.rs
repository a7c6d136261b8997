//! A stiffness that is NaN.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DelayedSpring<1>>> =
    scene(DelayedSpring { stiffness: f64::NAN }).certified();

fn main() {
    let _ = CERTIFIED;
}
