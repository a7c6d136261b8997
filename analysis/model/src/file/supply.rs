//! The supply of a scene file's bridge.

use haptic_servo::current::Bus;

use super::faults::Read;
use super::key;
use super::section::Section;

/// The contents of `[supply]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FileSupply {
    /// It takes energy back.
    Sinks {
        /// Largest speed of the device in rad/s.
        largest_speed: f64,
    },
    /// It takes none.
    Stores {
        /// The capacitance and its voltages.
        bus: Bus,
        /// Largest speed of the device in rad/s.
        largest_speed: f64,
    },
}

impl FileSupply {
    /// Whether it takes no energy back.
    pub const fn stores(&self) -> bool {
        matches!(self, Self::Stores { .. })
    }
}

/// Reads `[supply]`. A supply that does not sink needs a torque limit, which `torque` is if it is there.
pub fn supply(mut section: Section<'_>, torque: Option<f64>) -> Read<FileSupply> {
    let sinks = section.boolean(&key::SINKS);
    let numbers = [&key::SUPPLY_VOLTAGE, &key::FAULT_VOLTAGE, &key::CAPACITANCE];
    let numbers = numbers.map(|key| (key, section.optional(key)));
    let speed = section.number(&key::LARGEST_SPEED);
    section.finish();
    if sinks? == Some(true) {
        for (_, number) in numbers {
            number?;
        }
        return Ok(FileSupply::Sinks { largest_speed: speed? });
    }
    let [voltage, fault_level, capacitance] =
        numbers.map(|(key, number)| number?.ok_or_else(|| section.missing(key)));
    let (voltage, fault_level, capacitance) = (voltage?, fault_level?, capacitance?);
    if voltage >= fault_level {
        let reason = format!("is not below `{}` = {fault_level} V", key::FAULT_VOLTAGE.path);
        return Err(section.conflict(&key::SUPPLY_VOLTAGE, reason));
    }
    if torque.is_none() {
        let (limit, full) = (key::TORQUE_LIMIT.path, key::FULL_SCALE.path);
        let reason = format!("needs the largest torque beside it: set `{limit}` or `{full}`");
        return Err(section.conflict(&key::CAPACITANCE, reason));
    }
    let bus = Bus { voltage, capacitance, fault_level };
    Ok(FileSupply::Stores { bus, largest_speed: speed? })
}
