//! A spring of twice what a delay of one sample allows: alpha = K T / 2.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DelayedSpring<1>>> =
    scene(DelayedSpring { stiffness: 88.0 }).certified();

fn main() {
    let _ = CERTIFIED;
}
