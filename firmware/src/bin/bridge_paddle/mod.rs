//! The paddle with a brushed motor on a motor board, for `bridge_wall` and `bridge_identify`. For your own
//! device, change these numbers, or copy this module.

// A crate that includes several programs has this module in each.
#![allow(dead_code, clippy::duplicate_mod)]

use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, Motor, Regeneration, Supply, Winding,
};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::scene::Device;
use haptic_servo::servo::Transducers;

/// Period of the servo in s, 40 of the current loop.
pub const PERIOD: f64 = 0.001;

/// The part that the hand holds: inertia in kg m^2, damping in N m s/rad. Through the current loop, motion
/// takes 0.00253 of the damping (`CurrentLoop::motion_loss`), so the passivity is lower.
pub const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.0194) };

/// Its encoder, and its motor at the handle, behind a capstan of 1 to 10.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 1.0,
    largest_speed: 25.0,
};

/// The motor between the outputs U and V, and its supply: set to 24 V at most, it takes no energy back. So near
/// to the board's highest voltage it needs 10 mF at the bridge; a motor that needs less voltage runs from 12 to
/// 20 V with a tenth of that.
pub const DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushed,
        resistance: 0.6,
        inductance: 0.12e-3,
        torque_constant: 0.29,
    },
    supply: Supply {
        lowest: 23.5,
        highest: 25.2,
        regeneration: Regeneration::Stores { voltage: 24.0, capacitance: 10e-3 },
    },
    bandwidth: 2000.0,
    largest_temperature: 80.0,
};

/// Its current loop on the board's power stage: a motor that it cannot drive is a compile error here.
pub const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);
