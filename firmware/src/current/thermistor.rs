//! A thermistor with a negative coefficient, from the converter's supply to its input, and a resistor from
//! there to ground: the count rises with the temperature.

use crate::passivity::interval::Interval;

/// The converter's count at its supply: 12 bits.
pub(super) const LARGEST_COUNT: u16 = 4095;

/// 0 degrees Celsius in K.
const ZERO_CELSIUS: f64 = 273.15;

/// A thermistor above a resistor to ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermistor {
    /// Its resistance in ohm at 25 degrees Celsius.
    pub resistance: f64,
    /// The thermistor's constant B in K.
    pub beta: f64,
    /// The resistor in ohm.
    pub to_ground: f64,
}

impl Thermistor {
    /// Lowest temperature in degrees Celsius in the table.
    pub const LOWEST: i16 = -20;
    /// Highest temperature in degrees Celsius in the table.
    pub const HIGHEST: i16 = 140;
    const STEP: i16 = 10;
    /// Temperatures of a [`ThermistorTable`].
    const STEPS: usize = ((Self::HIGHEST - Self::LOWEST) / Self::STEP) as usize + 1;

    /// The count of the converter at a temperature in degrees Celsius.
    pub const fn count(&self, celsius: f64) -> u16 {
        let exponent = self.beta * (1.0 / (celsius + ZERO_CELSIUS) - 1.0 / (25.0 + ZERO_CELSIUS));
        let factor = Interval::exact(exponent.abs()).exp_of_negative().midpoint();
        let thermistor =
            if exponent < 0.0 { self.resistance * factor } else { self.resistance / factor };
        // The cast rounds a positive number down.
        (LARGEST_COUNT as f64 * self.to_ground / (self.to_ground + thermistor) + 0.5) as u16
    }

    /// Counts for a board, which does not compute exponential functions.
    pub(super) const fn table(&self) -> ThermistorTable {
        let (mut counts, mut i) = ([0; Self::STEPS], 0);
        while i < counts.len() {
            counts[i] = self.count((Self::LOWEST + Self::STEP * i as i16) as f64);
            i += 1;
        }
        ThermistorTable(counts)
    }
}

/// Counts of a thermistor, ten degrees apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ThermistorTable([u16; Thermistor::STEPS]);

impl ThermistorTable {
    /// The count at the lowest temperature: below it the thermistor is open.
    #[inline(always)]
    pub(super) const fn lowest(&self) -> u16 {
        self.0[0]
    }

    /// The count at the highest temperature: above it the thermistor is shorted.
    pub(super) const fn highest(&self) -> u16 {
        self.0[Thermistor::STEPS - 1]
    }

    /// The temperature of a count in tenths of a degree Celsius, by linear interpolation, clamped to the ends
    /// of the table.
    pub(super) const fn tenths(&self, count: u16) -> i32 {
        let (mut tenths, mut i) = (Thermistor::LOWEST as i32 * 10, 1);
        while i < self.0.len() {
            let (below, above) = (self.0[i - 1], self.0[i]);
            if count <= below {
                break;
            }
            let (width, part) = (above.saturating_sub(below), count - below);
            if part < width {
                return tenths + part as i32 * 100 / width as i32;
            }
            tenths += 100;
            i += 1;
        }
        tenths
    }
}
