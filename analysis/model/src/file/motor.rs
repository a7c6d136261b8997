//! The motor of a scene file, for a board's own bridge.

use haptic_servo::current::{IndexOffset, Motor, Winding};

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
    /// Its phase at the index of its encoder.
    pub index_offset: Option<IndexOffset>,
}

fn index_offset_of(mut section: Section<'_>) -> Read<IndexOffset> {
    let counts = section.number(&key::INDEX_OFFSET_COUNTS);
    let is_reversed = section.boolean(&key::INDEX_OFFSET_REVERSED);
    section.finish();
    Ok(IndexOffset { counts: counts? as u32, is_reversed: is_reversed?.unwrap_or(false) })
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
    let offset =
        section.table(&key::INDEX_OFFSET).and_then(|table| table.map(index_offset_of).transpose());
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
    let (lowest_supply, highest_supply) = (lowest_supply?, highest_supply?);
    Ok(FileMotor { motor, lowest_supply, highest_supply, index_offset: offset? })
}
