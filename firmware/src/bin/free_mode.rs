//! Free motion: the device's own damping, cancelled but for a residual, at the paper's numbers
//! (equations 22 and 23).
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::FreeMode;
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::Transducers;

/// What the hand feels: the paper's canceller, as late as a board's torque. It needs as much of the
/// device's damping with and without a sample of delay.
pub type Environment = FreeMode<1>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: FreeMode { residual: 0.001 },
    // The DAC range is the only limit. The certificate covers it: any part of the canceller's
    // torque takes no more than 0.021 N m s/rad.
    latency: Latency::NONE,
    torque_limit: None,
};

/// Its certificate: a scene that could oscillate in a hand stops the compiler here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();

/// The device's, with another amplifier gain. Full scale is the torque at 12 rad/s: half a DAC step
/// keeps a device without friction turning, at the speed of that torque over the residual. A finer
/// step makes it slower.
pub const TRANSDUCERS: Transducers = Transducers { full_scale_torque: 0.25, ..paddle::TRANSDUCERS };

/// Angles to 2048 rad, since what moves freely may turn on and on; in steps of 1e-6.
pub type Fixed = fixed::types::I12F20;

haptic_servo::scene_program! {
    scene: SCENE: Environment,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: Fixed,
}
