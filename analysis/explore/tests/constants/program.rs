//! a wall without delay, of program.toml.
#![cfg_attr(target_os = "none", no_std, no_main)]

use haptic_servo::certificate::Certified;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::Wall;
use haptic_servo::host::HostTorque;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};
use haptic_servo::servo::{AtPhase, Transducers};

/// The encoder, and the motor with its amplifier, at the handle: torque in N m, speed in rad/s.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 4096.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 0.3,
    largest_speed: 60.0,
};

/// When the torque of a count is put out, in nanoseconds after it.
pub type Output = AtPhase<10000>;

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 3e-5, damping: 0.003, passivity: None },
    timing: Timing { period: 0.0005, worst_period: None },
    coupling: Coupling::Rigid,
    environment: Wall::damped(1.0, 0.0001, 0).behind(0.0).alone(),
    latency: Latency {
        output_delay: TimeRange::exactly(1e-5),
        actuator_lag: TimeRange::exactly(5.3e-5),
        output_jitter: 1e-6,
        ..Latency::NONE
    },
    torque_limit: Some(0.2),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

/// What a host may do beside it.
pub const HOST: HostTorque =
    HostTorque { energy: 0.02, power: 0.1, damping: 0.0002, torque: 0.05, timeout: 0.05 };

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    host: HOST,
    transducers: TRANSDUCERS,
    output: Output,
    friction: 0.001,
}
