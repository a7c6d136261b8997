//! Damping that would take the certificate away.
use haptic_servo::servo::RenderingOptions;
use refusals::*;

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
    rendering: RenderingOptions { injection: Some(0.02), ..RenderingOptions::DEFAULT },
}
