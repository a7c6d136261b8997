//! Damping within what the scene leaves.
use firmware::environment::DelayedSpring;
use firmware::servo::RenderingOptions;
use refusals::*;

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
    rendering: RenderingOptions { injection: Some(0.01), ..RenderingOptions::DEFAULT },
}
