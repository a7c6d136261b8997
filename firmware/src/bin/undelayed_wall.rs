//! Free motion that ends at a wall, both without delay: the device's own damping is cancelled except for a
//! residual, and beyond a face there are a spring and a damper. The torque of a count is put out 10
//! microseconds after it; the coupling absorbs this delay and the lag of the amplifier.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DamperWall, FreeModeWall, Matched, OneSided};
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::AtPhase;
use haptic_servo::servo_loop::READ_WITHIN;
pub use paddle::TRANSDUCERS;

/// The environment that the hand feels, behind a coupling that absorbs the amplifier's lag.
pub type Environment = Matched<FreeModeWall<OneSided<DamperWall<0>>>, 0, 1>;

/// The time of the output: 1680 cycles of the slowest board, for about 150 instructions.
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
        // A count may be read this late, and is then nearer to its torque by the same time.
        output_jitter: READ_WITHIN,
        ..Latency::delayed(Output::DELAY)
    }
    // A current loop of 3 kHz.
    .with_actuator_lag(53e-6),
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
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
