//! A spring of twice what a delay of one sample allows: alpha = K T / 2.
use firmware::certificate::Certified;
use firmware::environment::DelayedSpring;
use firmware::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<DelayedSpring<1>>> =
    scene(DelayedSpring { stiffness: 88.0 }).certified();

fn main() {
    let _ = CERTIFIED;
}
