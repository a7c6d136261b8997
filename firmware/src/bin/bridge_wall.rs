//! The damper wall on a motor board: the board's own bridge drives a brushed motor, and the latency of its
//! current loop is the scene's.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod bridge_paddle;

pub use bridge_paddle::{CURRENT_LOOP, DRIVE, TRANSDUCERS};
use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Scene, Timing};

/// The scene.
pub const SCENE: Scene = Scene {
    device: bridge_paddle::DEVICE,
    timing: Timing { period: bridge_paddle::PERIOD, worst_period: None },
    coupling: Coupling::Matched,
    environment: Wall::damped(20.0, 0.009, 1).behind(0.0).alone(),
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    // Half of full scale: with more, the bare paddle would exceed its largest speed against its damping when a hand
    // lets go at the limit.
    torque_limit: Some(0.5),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    bridge: CURRENT_LOOP,
}
