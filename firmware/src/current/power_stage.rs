//! The power stage of a board: what its data sheets and its schematic say.

use super::motor::Supply;
use super::thermistor::Thermistor;

/// The numbers of a board's power stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerStage {
    /// Clock in Hz of the timer of the pulse-width modulation, which counts up and down.
    pub clock: f64,
    /// Current in A of a count of the converter, without its sign.
    pub amps_per_count: f64,
    /// Whether a current out of the bridge into the motor lowers the count. The shunts are between low side and
    /// ground, and such a current flows up through them: it lowers the count of an amplifier that does not
    /// invert, and raises that of one that does.
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
    pub const LARGEST_COUNT: u16 = 4095;
}
