//! What a board's power stage measures, in the units of a data sheet.

use std::fmt;

use firmware::power_reading::PowerReading;
use serde::Serialize;

/// A reading of a power stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Power {
    /// Current into the motor in A, with the sign of its torque.
    pub current: f64,
    /// Current in A of the torque that the servo asked for last.
    pub reference: f64,
    /// Voltage of the supply in V.
    pub voltage: f64,
    /// Temperature in degrees Celsius.
    pub temperature: f64,
}

impl From<PowerReading> for Power {
    fn from(reading: PowerReading) -> Self {
        let PowerReading { current, reference, voltage, temperature } = reading;
        Self {
            current: f64::from(current) / 1e3,
            reference: f64::from(reference) / 1e3,
            voltage: f64::from(voltage) / 1e3,
            temperature: f64::from(temperature) / 10.0,
        }
    }
}

impl fmt::Display for Power {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { current, reference, voltage, temperature } = self;
        write!(f, "current {current:.3} A of {reference:.3} A asked, ")?;
        write!(f, "supply {voltage:.1} V, {temperature:.1} C")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn json_is_in_the_units_that_are_printed() {
        let reading =
            PowerReading { current: -412, reference: 400, voltage: 24_070, temperature: -15 };
        let power = Power::from(reading);
        let json = json!(
            {"current": -0.412, "reference": 0.4, "voltage": 24.07, "temperature": -1.5}
        );
        assert_eq!(serde_json::to_value(power).unwrap(), json);
        let line = "current -0.412 A of 0.400 A asked, supply 24.1 V, -1.5 C";
        assert_eq!(power.to_string(), line);
    }
}
