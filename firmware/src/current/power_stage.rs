//! The power stage of a board, from its data sheets and its schematic, and the network of its sensors.

use crate::passivity::interval::Interval;

/// 0 degrees Celsius in K.
const ZERO_CELSIUS: f64 = 273.15;

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
    /// The largest count of a board's converters, of 12 bits: at their supply.
    pub const LARGEST_COUNT: u16 = 4095;

    /// The dead time in counts of the timer, rounded up.
    pub const fn dead_time_counts(&self) -> u8 {
        // The cast rounds a positive number down, and saturates.
        (self.dead_time * self.clock + (1.0 - 1e-6)) as u8
    }
}

/// A range of a supply's voltage in V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplyRange {
    /// The lowest.
    pub lowest: f64,
    /// The highest.
    pub highest: f64,
}

/// The range of codes of the thresholds' converter in which a working comparator trips without a current, and the
/// current of a code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TripRange {
    /// The lowest code.
    pub lowest: u16,
    /// The highest code.
    pub highest: u16,
    /// Current in A of a code.
    pub amps_per_code: f64,
}

impl TripRange {
    /// Instants of a search.
    pub const fn instants(&self) -> u32 {
        (self.highest - self.lowest) as u32 + 1
    }
}

/// A shunt, a resistor from it to an amplifier's non-inverting input, and two more from that input to ground
/// and to the converter's supply, which lift the voltage so that both directions of the current are in range.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CurrentSense {
    /// The shunt in ohm, from the low side to ground.
    shunt: f64,
    /// The resistor in ohm from the shunt to the amplifier's input.
    series: f64,
    /// The resistor in ohm from the amplifier's input to ground.
    to_ground: f64,
    /// The resistor in ohm from the amplifier's input to the converter's supply.
    to_supply: f64,
    /// Relative tolerance of these three resistors.
    resistor_tolerance: f64,
    gain: f64,
    /// Relative tolerance of the gain.
    gain_tolerance: f64,
    /// Largest offset in V of the amplifier's input, of either sign.
    amplifier_offset: f64,
    /// Largest offset in V of the comparator at the same input, of either sign.
    comparator_offset: f64,
    /// Largest error in V of the comparator's threshold.
    threshold_error: f64,
    /// The converter's supply in V, which is also its reference.
    reference: f64,
}

impl CurrentSense {
    /// Counts of the converter per volt.
    const fn counts_per_volt(&self) -> f64 {
        (PowerStage::LARGEST_COUNT as f64 + 1.0) / self.reference
    }

    /// Current in A of a count, without its sign.
    const fn amps_per_count(&self) -> f64 {
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

    /// The lowest and the highest count without a current, symmetric about the nominal count.
    const fn zero_counts(&self) -> (u16, u16) {
        let middle = self.zero(0.0);
        let off = (self.zero(1.0) - middle).max(middle - self.zero(-1.0));
        // The casts round positive numbers down.
        let (nearest, width) = ((middle + 0.5) as u16, off as u16 + 1);
        (nearest - width, nearest + width)
    }

    /// The codes of a threshold, of as many bits as a count, at which a working comparator trips without a
    /// current.
    const fn trip_range(&self) -> TripRange {
        let off = self.comparator_offset + self.threshold_error;
        TripRange {
            // The casts round positive numbers down.
            lowest: (self.counts_per_volt() * (self.input(-1.0) - off)) as u16,
            highest: (self.counts_per_volt() * (self.input(1.0) + off)) as u16 + 1,
            amps_per_code: self.amps_per_count() * self.gain,
        }
    }
}

/// A thermistor with a negative coefficient, from the converter's supply to its input, and a resistor from
/// there to ground: the count rises with the temperature.
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
        (PowerStage::LARGEST_COUNT as f64 * self.to_ground / (self.to_ground + thermistor) + 0.5)
            as u16
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

// Longer dead times are not linear in the timer's register.
const _: () = assert!(B_G431B_ESC1.dead_time_counts() < 128);
