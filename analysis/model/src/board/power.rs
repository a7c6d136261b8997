//! Measurements of a board's power stage, in the units of a data sheet.

use std::fmt;

use haptic_servo::current::IndexOffset;
use haptic_servo::power_reading::PowerReading;
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
    /// The phase of a brushless motor at its encoder's index, once both are known.
    pub index: Option<IndexOffset>,
}

impl Power {
    /// The offset of the index as a program states it.
    pub fn index_offset(&self) -> Option<String> {
        let IndexOffset { counts, is_reversed } = self.index?;
        let offset = format!("IndexOffset {{ counts: {counts}, is_reversed: {is_reversed} }}");
        Some(format!("the motor at the encoder's index: {offset}"))
    }
}

impl From<PowerReading> for Power {
    fn from(reading: PowerReading) -> Self {
        let PowerReading { current, reference, voltage, temperature, index } = reading;
        Self {
            current: f64::from(current) / 1e3,
            reference: f64::from(reference) / 1e3,
            voltage: f64::from(voltage) / 1e3,
            temperature: f64::from(temperature) / 10.0,
            index,
        }
    }
}

impl fmt::Display for Power {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { current, reference, voltage, temperature, .. } = self;
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
        let index = Some(IndexOffset { counts: 1187, is_reversed: true });
        let (current, reference, voltage, temperature) = (-412, 400, 24_070, -15);
        let power = Power::from(PowerReading { current, reference, voltage, temperature, index });
        let json = json!(
            {"current": -0.412, "reference": 0.4, "voltage": 24.07, "temperature": -1.5,
             "index": {"counts": 1187, "is_reversed": true}}
        );
        assert_eq!(serde_json::to_value(power).unwrap(), json);
        let line =
            "the motor at the encoder's index: IndexOffset { counts: 1187, is_reversed: true }";
        assert_eq!(power.index_offset().unwrap(), line);
        assert_eq!(Power { index: None, ..power }.index_offset(), None);
        let line = "current -0.412 A of 0.400 A asked, supply 24.1 V, -1.5 C";
        assert_eq!(power.to_string(), line);
    }
}
