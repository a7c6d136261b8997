//! A spring that pulls away from its rest position.
use firmware::certificate::Certified;
use firmware::environment::DelayedSpring;
use firmware::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DelayedSpring<0>>> =
    scene(DelayedSpring { stiffness: -22.0 }).certified();

fn main() {
    let _ = CERTIFIED;
}
