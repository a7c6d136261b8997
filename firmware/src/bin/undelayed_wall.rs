//! Free motion that ends at a wall, both without delay: the device's own damping is cancelled except for a
//! residual, and beyond a face there are a spring and a damper. The torque of a count is put out 10
//! microseconds after it; the coupling absorbs this delay and the lag of the amplifier.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Canceller, Parts, Wall};
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::AtPhase;
use haptic_servo::servo_loop::READ_WITHIN;
pub use paddle::TRANSDUCERS;

/// The time of the output: 1680 cycles of the slowest board, for about 150 instructions.
pub type Output = AtPhase<10_000>;

/// The scene.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Matched,
    environment: Parts {
        canceller: Some(Canceller::to(0.004)),
        wall: Some(Wall::damped(22.0, 0.01, 0).behind(0.0)),
        ..Parts::NONE
    }
    .sum(),
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
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    output: Output,
}
