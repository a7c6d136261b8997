//! Cancels all but a little of the device's damping.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::FreeMode;
use haptic_servo::scene::Scene;
use refusals::scene;

const CERTIFIED: Certified<Scene<FreeMode<0>>> = scene(FreeMode { residual: 0.001 }).certified();

fn main() {
    let _ = CERTIFIED;
}
