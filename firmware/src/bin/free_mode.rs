//! Free motion: cancels the device's own damping except for a residual, with the paper's numbers (equations
//! 22 and 23).
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Canceller;
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::Transducers;

/// The scene: the paper's canceller with the delay of a board's torque. It needs the same damping of the device
/// with and without a sample of delay.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Canceller { residual: 0.001, delay: 1 }.alone(),
    // The DAC range is the only limit. The certificate covers it: a limited torque of the canceller needs at
    // most 0.021 N m s/rad.
    latency: Latency::NONE,
    torque_limit: None,
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

/// The device's transducers with another amplifier gain. Full scale is the torque at 12 rad/s. Half a DAC
/// step keeps a device without friction turning, at the speed of that torque divided by the residual; a finer
/// step makes it slower.
pub const TRANSDUCERS: Transducers = Transducers { full_scale_torque: 0.25, ..paddle::TRANSDUCERS };

/// Angles to 2048 rad in steps of 1e-6, because a freely moving device may turn many times.
pub type Fixed = fixed::types::I12F20;

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: Fixed,
}
