//! The current loop against motors that are computed by the exact response of each stretch between two edges of
//! the switches.

mod aligned;
mod brushed;
mod brushless;
mod design;
mod faults;
mod rig;

use super::*;
use crate::transducers::Transducers;

/// A stage with the numbers of a small one: shunts of 3 milliohm, and amplifiers with a gain of 9.
const STAGE: PowerStage = PowerStage {
    clock: 170e6,
    amps_per_count: 0.03,
    current_lowers_count: true,
    volts_per_count: 0.0084,
    volts_tolerance: 0.02,
    largest_current: 40.0,
    offset_counts: (2390, 2716),
    continuous_current: 40.0,
    largest_temperature: 120.0,
    trip_range: TripRange { lowest: 140, highest: 180, amps_per_code: 0.5 },
    trip_margin: 8.0,
    charging: 10e-3,
    supply: SupplyRange { lowest: 10.0, highest: 34.0 },
    dead_time: 0.2e-6,
    shortest_low: 1.5e-6,
    thermistor: Thermistor { resistance: 10e3, beta: 3380.0, to_ground: 4.7e3 },
};

const DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushed,
        resistance: 0.6,
        inductance: 0.3e-3,
        torque_constant: 0.05,
    },
    supply: Supply::sinking(22.0, 26.0),
    bandwidth: 1000.0,
    largest_temperature: 90.0,
};

/// Full scale is 4 A.
const TRANSDUCERS: Transducers =
    Transducers { full_scale_torque: 0.2, ..crate::test_scene::PADDLE };

/// Forty instants, of 25 microseconds.
const PERIOD: f64 = 1e-3;
const INSTANT: f64 = 25e-6;

/// Full scale, 1791 codes, is 4 A.
const BRUSHED: CurrentLoop = CurrentLoop::checked(&DRIVE, &STAGE, &TRANSDUCERS, PERIOD);

/// A motor of seven pole pairs, whose phases have half of the brushed one's resistance.
const BRUSHLESS_DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushless { pole_pairs: 7 },
        resistance: 0.3,
        inductance: 0.15e-3,
        torque_constant: 0.05,
    },
    ..DRIVE
};

const BRUSHLESS: CurrentLoop = CurrentLoop::checked(&BRUSHLESS_DRIVE, &STAGE, &TRANSDUCERS, PERIOD);

const FULL_SCALE: i16 = 1791;

/// What the certificate knows: the steps of a lag behind a delay of an instant, as sums of exponential functions
/// and not by a recursion.
fn certified_current(design: &CurrentLoop, steps: &[(usize, i16)], instant: usize) -> f64 {
    let TorqueResponse { delay, lag, .. } = design.response();
    let (mut last, mut current) = (0, 0.0);
    for &(at, code) in steps {
        let time = (instant as f64 - at as f64) * INSTANT - delay;
        let amps = f64::from(code - last) / 1791.0 * design.full_scale_current();
        current += if time > 0.0 { -amps * (-time / lag).exp_m1() } else { 0.0 };
        last = code;
    }
    current
}

/// Steps over the whole range of torque and to the smallest codes: instants, and the codes from there on.
const STEPS: [(usize, i16); 4] = [(3, FULL_SCALE), (100, -FULL_SCALE), (140, 300), (300, 0)];

/// The code of an instant by such steps.
fn code_at(steps: &[(usize, i16)], instant: usize) -> i16 {
    steps.iter().rev().find(|step| step.0 <= instant).map_or(0, |step| step.1)
}

/// Deviation in A that counts may leave, with what the ripple leaves of it at the samples: it is of the second
/// order in the resistance.
fn allowed(design: &CurrentLoop) -> f64 {
    design.resolution().deviation / design.torque_per_amp() + 0.01
}
