//! Whether the supply of a scene's bridge stays below the fault level after a hand's push (theory, section 17).

use haptic_servo::current::{Bus, Push, RegenerationError};
use serde::Serialize;

use crate::file::SceneFile;
use crate::file::supply::FileSupply;
use crate::quantity::significant;

/// The answer for a supply.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SupplyReport {
    /// Whether it stays below the fault level; `None` if no bound on the energy is known.
    pub stays_below: Option<bool>,
    /// Whether it takes energy back.
    pub sinks: bool,
    /// Largest energy in J that the scene returns; `None` if no bound is known or needed.
    pub energy: Option<f64>,
    /// Highest voltage in V after that.
    pub voltage: Option<f64>,
    /// Lowest voltage in V at which the bridge may switch itself off.
    pub fault_voltage: Option<f64>,
    /// Least capacitance in F for that energy, where it is the only change.
    pub least_capacitance: Option<f64>,
    /// Largest voltage in V of the supply, in the same way.
    pub largest_voltage: Option<f64>,
    /// Largest torque limit in N m, in the same way; `None` where it may stay, or none is low enough.
    pub largest_torque: Option<f64>,
    /// The answer as a sentence.
    pub message: String,
}

/// The condition of the answer.
pub const ASSUMPTION: &str = "supply: a hand pushes in one direction, no farther than where the scene at rest has \
                              its torque limit, over one period of a torque profile or its range, and lets go; \
                              a hand that goes on turning against the torque feeds the supply for as long, \
                              which only one that sinks bears";

/// The answer for the supply of a scene file; `None` if the file states none.
pub fn judge(file: &SceneFile) -> Option<SupplyReport> {
    let (bus, largest_speed) = match file.supply? {
        FileSupply::Sinks => return Some(sinking()),
        FileSupply::Stores { bus, largest_speed } => (bus, largest_speed),
    };
    // The reader has refused a file with neither.
    let torque = file.scene.torque_limit.or(file.full_scale).unwrap_or(f64::INFINITY);
    let push = Push { torque, speed: largest_speed, injected: 0.0, winding: 0.0 };
    Some(match bus.check(&file.scene, &push) {
        Ok(energy) => {
            let (energy, level) = (energy.total(), bus.fault_level);
            let voltage = bus.voltage_after(energy);
            let [joules, volts] = [energy, voltage].map(|value| significant(value, 4));
            let message = format!(
                "a push returns up to {joules} J, which raises it to {volts} V, below the {level} V at which \
                 the bridge may switch itself off"
            );
            of(&bus, Some(true), Some(energy), message)
        }
        Err(error @ RegenerationError::Unbounded) => of(&bus, None, None, error.to_string()),
        Err(error @ RegenerationError::OverVoltage { energy, torque, .. }) => {
            let report = of(&bus, Some(false), Some(energy.total()), error.to_string());
            SupplyReport { largest_torque: (torque > 0.0).then_some(torque), ..report }
        }
    })
}

fn sinking() -> SupplyReport {
    SupplyReport {
        stays_below: Some(true),
        sinks: true,
        energy: None,
        voltage: None,
        fault_voltage: None,
        least_capacitance: None,
        largest_voltage: None,
        largest_torque: None,
        message: "takes back what the motor returns, and keeps its voltage".to_owned(),
    }
}

fn of(bus: &Bus, stays_below: Option<bool>, energy: Option<f64>, message: String) -> SupplyReport {
    SupplyReport {
        stays_below,
        energy,
        voltage: energy.map(|energy| bus.voltage_after(energy)),
        fault_voltage: Some(bus.fault_level),
        least_capacitance: energy.and_then(|energy| bus.least_capacitance(energy)),
        largest_voltage: energy.and_then(|energy| bus.largest_voltage(energy)),
        message,
        ..SupplyReport { sinks: false, ..sinking() }
    }
}
