//! The motor of a scene file, for a board's own bridge.

use haptic_servo::current::{IndexOffset, Motor, Winding};

use super::faults::Read;
use super::key;
use super::section::Section;
use super::transducers::counts_per_turn_of;

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
    let (lowest_supply, highest_supply, index_offset) = (lowest_supply?, highest_supply?, offset?);
    if lowest_supply > highest_supply {
        let reason = format!("is above `{}` = {highest_supply} V", key::HIGHEST_SUPPLY.path);
        return Err(section.conflict(&key::LOWEST_SUPPLY, reason));
    }
    if index_offset.is_some() && !winding.is_brushless() {
        let reason =
            format!("stands without `{}`: a brushed motor has no phase", key::POLE_PAIRS.path);
        return Err(section.conflict(&key::INDEX_OFFSET, reason));
    }
    Ok(FileMotor { motor, lowest_supply, highest_supply, index_offset })
}

impl FileMotor {
    /// Checks the phase of the motor at an encoder with this angle in rad of a count; nothing is known without one.
    pub fn check_phase(&self, top: &Section<'_>, encoder_step: Option<f64>) -> Read<()> {
        let Some(step) = encoder_step else { return Ok(()) };
        let (winding, counts) = (self.motor.winding, counts_per_turn_of(step));
        let refused = |key, error| top.conflict(key, format!("cannot be used: {error}"));
        winding.check_pole_pairs(counts).map_err(|error| refused(&key::POLE_PAIRS, error))?;
        let Some(offset) = self.index_offset else { return Ok(()) };
        let offset = winding.check_offset(offset, counts);
        offset.map_err(|error| refused(&key::INDEX_OFFSET_COUNTS, error))
    }
}
