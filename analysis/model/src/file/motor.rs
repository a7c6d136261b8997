//! The motor of a scene file, for a board's own bridge.

use haptic_servo::current::{Motor, Winding};

use super::faults::Read;
use super::key;
use super::section::Section;

/// The contents of `[motor]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileMotor {
    /// The motor.
    pub motor: Motor,
    /// Lowest voltage in V of its supply, under load.
    pub lowest_supply: f64,
    /// Highest voltage in V, when the motor feeds the supply.
    pub highest_supply: f64,
}

/// Reads `[motor]`.
pub fn motor(mut section: Section<'_>) -> Read<FileMotor> {
    let pole_pairs = section.value(&key::POLE_PAIRS);
    let numbers = [
        &key::RESISTANCE,
        &key::INDUCTANCE,
        &key::TORQUE_CONSTANT,
        &key::LOWEST_SUPPLY,
        &key::HIGHEST_SUPPLY,
    ]
    .map(|key| section.number(key));
    section.finish();
    let [resistance, inductance, torque_constant, lowest_supply, highest_supply] = numbers;
    let winding = pole_pairs?.map_or(Winding::Brushed, |pole_pairs| Winding::Brushless {
        pole_pairs: pole_pairs as u16,
    });
    let motor = Motor {
        winding,
        resistance: resistance?,
        inductance: inductance?,
        torque_constant: torque_constant?,
    };
    Ok(FileMotor { motor, lowest_supply: lowest_supply?, highest_supply: highest_supply? })
}
