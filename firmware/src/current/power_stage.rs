//! The power stage of a board, from its data sheets and its schematic.

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
    /// Largest current in A of a phase that can be measured and that the board tolerates.
    pub largest_current: f64,
    /// Lowest and highest count of a working amplifier without a current.
    pub offset_counts: (u16, u16),
    /// The supply range of the board.
    pub supply: Supply,
    /// Time in s for which both sides of a phase are off at a switching.
    pub dead_time: f64,
    /// Shortest time in s for which each low side must conduct in a period, to sample its current and to
    /// charge the supply of the high side's gate.
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
/// The shunts are of 3 mΩ. Behind them a divider leaves 4/7 and lifts the voltage to the middle of an
/// amplifier with a gain of 16, whose output the converters count: 64/7 together, so that a count is 29.4 mA.
/// The amplifiers also offer gains of 32 and 64, but these would also amplify the lifted voltage, and the
/// output would be at its rail without a current.
pub const B_G431B_ESC1: PowerStage = PowerStage {
    clock: 170e6,
    amps_per_count: 3.3 / 4096.0 / (0.003 * 64.0 / 7.0),
    current_lowers_count: true,
    // 169 kΩ over 18 kΩ.
    volts_per_count: 3.3 / 4096.0 * (169.0 + 18.0) / 18.0,
    // The shunts tolerate 40 A; half of the converters' range in each direction is 60 A; the rest is a margin
    // for a step.
    largest_current: 30.0,
    offset_counts: (1848, 2248),
    // Up to a battery of six cells; below 7 V the supply of the gate drivers may be too low.
    supply: Supply { lowest: 7.0, highest: 25.2 },
    dead_time: 0.5e-6,
    // Half of it is for the settling of the shunts' voltage, 1.3 us, and the sampling itself.
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

// Longer dead times are not linear in the timer's register.
const _: () = assert!(B_G431B_ESC1.dead_time_counts() < 128);
