//! A shaft with a brushless motor on a motor board, whose encoder has an index, for `brushless_wall`,
//! `brushless_index` and `brushless_identify`. For your own device, change these numbers, or copy this module.

// A crate that includes several programs has this module in each.
#![allow(dead_code, clippy::duplicate_mod)]

use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, EncoderIndex, Motor, Regeneration, Supply, Winding,
};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::Wall;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Device, Scene, Timing};
use haptic_servo::servo::Transducers;

/// Period of the servo in s: four of the current loop.
pub const PERIOD: f64 = 0.0001;

/// The encoder of the shaft, and its motor.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 16_384.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 0.15,
    largest_speed: 60.0,
};

/// The motor between the outputs U, V and W, in any order, and its supply, which takes no energy back.
pub const DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushless { pole_pairs: 7 },
        resistance: 0.3,
        inductance: 0.06e-3,
        torque_constant: 0.05,
    },
    supply: Supply {
        lowest: 20.0,
        highest: 25.2,
        regeneration: Regeneration::Stores { voltage: 20.5, capacitance: 1e-3 },
    },
    bandwidth: 2000.0,
    largest_temperature: 80.0,
};

/// Its current loop on the board's power stage. With an encoder without an index, the input does not change,
/// and lost counts are not found.
pub const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &TRANSDUCERS, PERIOD)
        .with_index(EncoderIndex { offset: None });

/// The scene.
pub const SCENE: Scene = Scene {
    // Through the current loop, motion takes 0.0001 of the damping (`CurrentLoop::motion_loss`).
    device: Device { inertia: 1.5e-5, damping: 0.0005, passivity: Some(0.00039) },
    timing: Timing { period: PERIOD, worst_period: None },
    coupling: Coupling::Matched,
    environment: Wall::damped(2.0, 0.0001, 1).behind(0.0).alone(),
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    torque_limit: Some(0.1),
};
