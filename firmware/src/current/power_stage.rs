//! The power stage of a board, from its data sheets and its schematic.

use super::current_sense::CurrentSense;
use super::motor::SupplyRange;
use super::thermistor::{LARGEST_COUNT, Thermistor};
use super::trip_search::TripRange;

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
    /// Largest relative error of that.
    pub volts_tolerance: f64,
    /// Largest current in A of a phase that can be measured and that the board tolerates.
    pub largest_current: f64,
    /// Current in A that the board bears for ever without a flow of air; a larger current is for a short time.
    pub continuous_current: f64,
    /// Highest temperature in degrees Celsius at the board's sensor for which a drive may be designed.
    pub largest_temperature: f64,
    /// Lowest and highest count of a working amplifier without a current.
    pub offset_counts: (u16, u16),
    /// The range in which a working comparator of the over-current protection trips without a current.
    pub trip_range: TripRange,
    /// Smallest current in A between that trip and the threshold, so that switching does not trip.
    pub trip_margin: f64,
    /// Time in s for which all low sides must conduct before the first high side, to charge the supplies of the
    /// high sides' gates.
    pub charging: f64,
    /// The supply range of the board.
    pub supply: SupplyRange,
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

/// The current sense of the B-G431B-ESC1.
///
/// The three resistors are those of the schematic of MB1419, as a reader of it states and computes with in
/// community.simplefoc.com/t/b-g431b-esc1-current-control/521; without a current they give 0.1286 V, and 2.057 V
/// behind the gain, which is the offset in ST's motor-control configuration of this board. The comparators' offset
/// is from -9 to +3 mV (DS12589). From memory, not read in the parts list or the data sheet: resistors of 1 %; of
/// the amplifier (DS12589) 2 % for the gain and 3 mV for the offset over the temperature; 3 mV for the
/// thresholds' converter. The amplifiers also offer gains of 32 and 64, which would put the
/// lifted voltage at the output's rail.
const B_G431B_ESC1_SENSE: CurrentSense = CurrentSense {
    shunt: 0.003,
    series: 1.5e3,
    to_ground: 2.2e3,
    to_supply: 22e3,
    resistor_tolerance: 0.01,
    gain: 16.0,
    gain_tolerance: 0.02,
    amplifier_offset: 3e-3,
    comparator_offset: 9e-3,
    threshold_error: 3e-3,
    reference: 3.3,
};

/// The power stage of the B-G431B-ESC1, by its user manual (UM2516), the schematic of MB1419, and the data sheet
/// of its gate drivers (L6387E).
///
/// A count of a converter is 29.4 mA. Without a current it is 2553, nearer to the upper end of the range: a
/// current out of the bridge into the motor lowers it and is measured to 75 A, and a current into the bridge
/// raises it and is measured to 45 A, with the nominal parts.
pub const B_G431B_ESC1: PowerStage = PowerStage {
    clock: 170e6,
    amps_per_count: B_G431B_ESC1_SENSE.amps_per_count(),
    current_lowers_count: true,
    // 169 kΩ over 18 kΩ.
    volts_per_count: 3.3 / 4096.0 * (169.0 + 18.0) / 18.0,
    // Two resistors of 1 % in the divider, from memory, and a little for the converter's reference.
    volts_tolerance: 0.022,
    // UM2516 tested the board with a peak of 40 A; with the parts at their worst the smaller half of the
    // converters' range ends at 40.5 A; the rest is a margin for a step.
    largest_current: 30.0,
    // An estimate, not measured and not in UM2516: at 10 A switches, shunts and switching take about 4 W, which the
    // small board gives away at some 60 degrees above the room. UM2516's 40 A are with a propeller's flow of air.
    continuous_current: 10.0,
    // The sensor is beside the switches, which are hotter. The limit of ST's motor-control configurations is 70
    // to 90; the components are rated for more.
    largest_temperature: 90.0,
    offset_counts: B_G431B_ESC1_SENSE.zero_counts(),
    trip_range: B_G431B_ESC1_SENSE.trip_range(),
    // 15 mV at the comparator.
    trip_margin: 8.75,
    // As in ST's motor-control software (`M1_CHARGE_BOOT_CAP_MS`).
    charging: 10e-3,
    // Up to a battery of six cells; below 8 to 9 V the gate drivers are outside of their specification, and the
    // under-voltage limit of ST's motor-control configurations is 8 V.
    supply: SupplyRange { lowest: 9.0, highest: 25.2 },
    // ST's motor-control configurations have 0.75 us (`SW_DEADTIME_NS`); nobody has measured how much less the
    // switches need. 0.74 us are 126 counts, as long as the timer's register is linear.
    dead_time: 0.74e-6,
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
