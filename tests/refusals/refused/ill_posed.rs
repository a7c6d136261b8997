//! An undelayed spring as negative as the coupling is stiff: their loop has no solution.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::DelayedSpring;
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DelayedSpring<0>>> =
    scene(DelayedSpring { stiffness: -44.0 }).certified();

fn main() {
    let _ = CERTIFIED;
}
