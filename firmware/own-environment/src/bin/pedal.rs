//! A pedal that gets stiffer: the program of an environment that is not in the firmware.
#![cfg_attr(target_os = "none", no_std, no_main)]

use haptic_servo::certificate::Certified;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::Transducers;
use own_environment::ProgressiveSpring;

/// The environment that the foot feels.
pub type Environment = ProgressiveSpring<1>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: ProgressiveSpring { soft: 4.0, stiff: 24.0, knee: 0.1 },
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate, from the bounds that the type states: an environment that could oscillate is a compile
/// error here.
pub const CERTIFIED: Certified<Scene<Environment>> =
    SCENE.certified_as(SCENE.environment.stated_at(SCENE.timing.period));

/// Its sensor and its motor.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};

/// Angles to 128 rad and torques to 128 N m, in steps of 6e-8.
pub type Fixed = fixed::types::I8F24;

haptic_servo::scene_program! {
    scene: SCENE: Environment,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: Fixed,
}
