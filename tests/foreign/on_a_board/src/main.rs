//! A knob with a detent: a foreign program for a board.
#![no_std]
#![no_main]

use haptic_servo::certificate::Certified;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::Wall;
use haptic_servo::number::fixed::types::I8F24;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::Transducers;
use haptic_servo::servo_loop::{LinkPolicy, Options};

/// A detent, as late as the board's torque.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 1e-5, damping: 0.01, passivity: None },
    timing: Timing { period: 0.0005, worst_period: None },
    coupling: Coupling::Spring { stiffness: 40.0 },
    environment: Wall::damped(12.0, 0.004, 1).alone(),
    latency: Latency::NONE,
    torque_limit: None,
};

/// Its certificate.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

/// The knob's encoder and motor.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 10_000.0,
    counter: CounterWidth::Bits32,
    full_scale_torque: 0.5,
    largest_speed: Transducers::NO_HAND_IS_FASTER,
};

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: I8F24,
    options: Options { link: LinkPolicy::Hold, ..Options::DEFAULT },
}
