//! The stiffest spring of the paddle at 1 kHz: a spring without delay that is much stiffer than the
//! coupling in front of it, whose torque is put out 5 microseconds after its count, through a current loop
//! of 3 kHz.
//!
//! At rest both are springs in a row, `1 / (1/K + (T + d + tau) / (2 delta))` with what the certificate
//! takes off `delta` for counts that are read late: 38.5 N m/rad, of which the coupling has 39.1.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DelayedSpring, Matched};
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::AtPhase;
use haptic_servo::servo_loop::READ_WITHIN;
pub use paddle::TRANSDUCERS;

/// What the hand feels, behind a coupling that remembers the amplifier's lag.
pub type Environment = Matched<DelayedSpring<0>, 0, 1>;

/// When a torque is put out: the shortest phase that there is.
pub type Output = AtPhase<5_000>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Matched,
    environment: Matched { environment: DelayedSpring { stiffness: 2400.0 } },
    latency: Latency {
        // A count may be read that late, and is so much nearer to its torque.
        output_jitter: READ_WITHIN,
        ..Latency::delayed(Output::DELAY)
    }
    // A current loop of 3 kHz: 1 / (2 pi 3000).
    .with_actuator_lag(53.0517e-6),
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand stops the compiler here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();

/// Angles to 128 rad and torques to 128 N m, in steps of 6e-8.
pub type Fixed = fixed::types::I8F24;

haptic_servo::scene_program! {
    scene: SCENE: Environment,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: Fixed,
    output: Output,
}
