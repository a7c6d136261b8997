//! The stiffest spring of the paddle at 1 kHz: a spring without delay, much stiffer than its coupling. Its
//! torque is put out 5 microseconds after its count, through a current loop of 3 kHz.
//!
//! At rest both are springs in series, `1 / (1/K + (T + d + tau + 3 h T) / (2 delta))`, with a coupling that is
//! softer by counts that are read up to `h T` late: 40.7 N m/rad, with 41.4 for the coupling alone.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::AtPhase;
use haptic_servo::servo_loop::READ_WITHIN;
pub use paddle::TRANSDUCERS;

/// The time of the output: the shortest possible phase.
pub type Output = AtPhase<5_000>;

/// The scene.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Matched,
    environment: Wall::spring(2400.0, 0).alone(),
    latency: Latency {
        // A count may be read this late, and is then nearer to its torque by the same time.
        output_jitter: READ_WITHIN,
        ..Latency::delayed(Output::DELAY)
    }
    // A current loop of 3 kHz: 1 / (2 pi 3000).
    .with_actuator_lag(53.0517e-6),
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    output: Output,
}
