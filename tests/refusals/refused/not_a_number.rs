//! A stiffness that is no number.
use firmware::certificate::Certified;
use firmware::environment::DelayedSpring;
use firmware::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DelayedSpring<1>>> =
    scene(DelayedSpring { stiffness: f64::NAN }).certified();

fn main() {
    let _ = CERTIFIED;
}
