//! An environment of another crate whose own statement does not pass.
use haptic_servo::certificate::Certified;
use haptic_servo::scene::Scene;
use own_environment::ProgressiveSpring;
use refusals::scene;

const PEDAL: Scene<ProgressiveSpring<1>> =
    scene(ProgressiveSpring { soft: 4.0, stiff: 60.0, knee: 0.1 });

const CERTIFIED: Certified<Scene<ProgressiveSpring<1>>> =
    PEDAL.certified_as(PEDAL.environment.stated_at(PEDAL.timing.period));

fn main() {
    let _ = CERTIFIED;
}
