//! The power stage of a board: what its data sheets and its schematic say.

use super::motor::Supply;
use super::thermistor::{LARGEST_COUNT, Thermistor};

/// The numbers of a board's power stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerStage {
    /// Clock in Hz of the timer of the pulse-width modulation, which counts up and down.
    pub clock: f64,
    /// Current in A of a count of the converter, without its sign.
    pub amps_per_count: f64,
    /// Whether a current out of the bridge into the motor lowers the count. The shunts are between low side
    /// and ground, and such a current flows up through them: it lowers the count of a non-inverting amplifier
    /// and raises that of an inverting one.
    pub current_lowers_count: bool,
    /// Supply voltage in V of a count of the converter.
    pub volts_per_count: f64,
    /// Largest current in A of a phase that can be measured and that the board bears.
    pub largest_current: f64,
    /// Lowest and highest count without a current, of an amplifier that is not broken.
    pub offset_counts: (u16, u16),
    /// Supply that the board bears.
    pub supply: Supply,
    /// Time in s for which both sides of a phase are off between one and the other.
    pub dead_time: f64,
    /// Shortest time in s for which each low side has to conduct in a period: for its current to be sampled,
    /// and for the supply of the high side's gate to be charged.
    pub shortest_low: f64,
    /// The sensor of the temperature.
    pub thermistor: Thermistor,
}

impl PowerStage {
    /// The largest count of a board's converters.
    pub const LARGEST_COUNT: u16 = LARGEST_COUNT;
}

/// The power stage of the B-G431B-ESC1, by its user manual (UM2516), the schematic of MB1419, and the data sheet
/// of its gate drivers (L6387E).
///
/// The shunts are of 3 mΩ. Behind them a divider leaves 4/7 and lifts the voltage to the middle of an amplifier
/// with a gain of 16, whose output the converters count: 64/7 together, which 29.4 mA move by a count. The gain
/// is not higher, although the amplifiers can have 32 and 64: they would multiply that lift, too, and be at their
/// rail without a current.
pub const B_G431B_ESC1: PowerStage = PowerStage {
    clock: 170e6,
    amps_per_count: 3.3 / 4096.0 / (0.003 * 64.0 / 7.0),
    current_lowers_count: true,
    // 169 kΩ over 18 kΩ.
    volts_per_count: 3.3 / 4096.0 * (169.0 + 18.0) / 18.0,
    // The shunts bear 40 A; half of the converters' range each way is 60 A; the rest is for a step.
    largest_current: 30.0,
    offset_counts: (1848, 2248),
    // Up to a battery of six cells; below 7 V the gate drivers may have too little.
    supply: Supply { lowest: 7.0, highest: 25.2 },
    dead_time: 0.5e-6,
    // Half of it until the shunts' voltage has settled, 1.3 us, with the sampling itself.
    shortest_low: 3.2e-6,
    // 10 kΩ from the 3.3 V, 4.7 kΩ to ground.
    thermistor: Thermistor { resistance: 10e3, beta: 3455.0, to_ground: 4.7e3 },
};

impl PowerStage {
    /// The dead time in counts of the timer, rounded up.
    pub const fn dead_time_counts(&self) -> u8 {
        // The cast rounds a positive number down, and saturates.
        (self.dead_time * self.clock + (1.0 - 1e-6)) as u8
    }
}

// Longer ones are not linear in the timer's register.
const _: () = assert!(B_G431B_ESC1.dead_time_counts() < 128);
