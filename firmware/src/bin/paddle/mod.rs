//! The device of this project's scenes: the paddle of the paper's examples. Your own scenes use *your*
//! device, from a file: `cargo haptic new NAME --from PROGRAM --device knob.toml`.

// A crate that includes several scenes has this module in each.
#![allow(dead_code, clippy::duplicate_mod)]

use haptic_servo::encoder::CounterWidth;
use haptic_servo::scene::Device;
use haptic_servo::servo::Transducers;

/// The part that the hand holds: inertia in kg m^2, damping in N m s/rad.
pub const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

/// Its encoder and its motor with amplifier, at the handle: torque in N m, speed in rad/s.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};
