//! The network between a shunt and its amplifier, and the counts that follow from its parts.

use super::thermistor::LARGEST_COUNT;
use super::trip_search::TripRange;

/// A shunt, a resistor from it to an amplifier's non-inverting input, and two more from that input to ground
/// and to the converter's supply, which lift the voltage so that both directions of the current are in range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CurrentSense {
    /// The shunt in ohm, from the low side to ground.
    pub shunt: f64,
    /// The resistor in ohm from the shunt to the amplifier's input.
    pub series: f64,
    /// The resistor in ohm from the amplifier's input to ground.
    pub to_ground: f64,
    /// The resistor in ohm from the amplifier's input to the converter's supply.
    pub to_supply: f64,
    /// Relative tolerance of these three resistors.
    pub resistor_tolerance: f64,
    /// Gain of the amplifier.
    pub gain: f64,
    /// Relative tolerance of the gain.
    pub gain_tolerance: f64,
    /// Largest offset in V of the amplifier's input, of either sign.
    pub amplifier_offset: f64,
    /// Largest offset in V of the comparator at the same input, of either sign.
    pub comparator_offset: f64,
    /// Largest error in V of the comparator's threshold.
    pub threshold_error: f64,
    /// The converter's supply in V, which is also its reference.
    pub reference: f64,
}

impl CurrentSense {
    /// Counts of the converter per volt.
    const fn counts_per_volt(&self) -> f64 {
        (LARGEST_COUNT as f64 + 1.0) / self.reference
    }

    /// Current in A of a count, without its sign.
    pub const fn amps_per_count(&self) -> f64 {
        let conductance = 1.0 / self.series + 1.0 / self.to_ground + 1.0 / self.to_supply;
        let left = 1.0 / self.series / conductance;
        1.0 / (self.counts_per_volt() * self.gain * left * self.shunt)
    }

    /// Voltage at the amplifier's input without a current if the resistors deviate by so many times their
    /// tolerance, each in the direction that moves the voltage by the sign of `times`.
    const fn input(&self, times: f64) -> f64 {
        let off = times * self.resistor_tolerance;
        let up = 1.0 / (self.to_supply * (1.0 - off));
        let down = 1.0 / (self.to_ground * (1.0 + off)) + 1.0 / (self.series * (1.0 + off));
        self.reference * up / (up + down)
    }

    /// The count without a current, likewise for all parts.
    const fn zero(&self, times: f64) -> f64 {
        let input = self.input(times) + times * self.amplifier_offset;
        self.counts_per_volt() * self.gain * (1.0 + times * self.gain_tolerance) * input
    }

    /// The count without a current, with the nominal parts: rounded to the nearest.
    pub const fn zero_count(&self) -> u16 {
        // The casts round positive numbers down, and saturate.
        (self.zero(0.0) + 0.5) as u16
    }

    /// The lowest and the highest count without a current, symmetric about the nominal count.
    pub const fn zero_counts(&self) -> (u16, u16) {
        let middle = self.zero(0.0);
        let off = (self.zero(1.0) - middle).max(middle - self.zero(-1.0));
        let width = off as u16 + 1;
        (self.zero_count() - width, self.zero_count() + width)
    }

    /// The codes of a threshold, of as many bits as a count, at which a working comparator trips without a
    /// current.
    pub const fn trip_range(&self) -> TripRange {
        let off = self.comparator_offset + self.threshold_error;
        TripRange {
            // The casts round positive numbers down.
            lowest: (self.counts_per_volt() * (self.input(-1.0) - off)) as u16,
            highest: (self.counts_per_volt() * (self.input(1.0) + off)) as u16 + 1,
            amps_per_code: self.amps_per_count() * self.gain,
        }
    }
}
