//! Free motion that ends at a wall, both without delay: the device's own damping is cancelled but for a
//! residual, and beyond a face there are a spring and a damper. The torque of a count is put out 10
//! microseconds after it; the coupling absorbs that together with the lag of the amplifier.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DamperWall, FreeModeWall, Matched, OneSided};
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::AtPhase;
use haptic_servo::servo_loop::READ_WITHIN;
pub use paddle::TRANSDUCERS;

/// What the hand feels, behind a coupling that remembers the amplifier's lag.
pub type Environment = Matched<FreeModeWall<OneSided<DamperWall<0>>>, 0, 1>;

/// When a torque is put out: 1680 cycles of the slowest board, for about 150 instructions.
pub type Output = AtPhase<10_000>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Matched,
    environment: Matched {
        environment: FreeModeWall {
            residual: 0.004,
            wall: OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } },
        },
    },
    latency: Latency {
        // A count may be read that late, and is so much nearer to its torque.
        output_jitter: READ_WITHIN,
        ..Latency::delayed(Output::DELAY)
    }
    // A current loop of 3 kHz.
    .with_actuator_lag(53e-6),
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
