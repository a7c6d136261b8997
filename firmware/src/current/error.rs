//! Reasons why a drive cannot run on a power stage.

use super::motor::SupplyRange;
use crate::text::{Text, error_with_sentence, push};

/// The reason why there is no current loop, with the value and its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveError {
    /// A number is zero, negative or not finite.
    NotPositive {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// An electrical turn has too few counts of the encoder, or none.
    PolePairs {
        /// Pole pairs.
        pole_pairs: u16,
        /// The largest number that the encoder allows.
        largest: u16,
    },
    /// A brushless motor needs a whole number of counts per turn.
    Counts {
        /// How many there are.
        counts: f64,
        /// The most that there may be.
        largest: f64,
    },
    /// An index was given for a brushed motor, which has no phase.
    IndexNotNeeded,
    /// An electrical turn has too few counts for its phase to come from the index.
    IndexCounts {
        /// How many there are.
        counts: f64,
        /// The fewest that there may be.
        least: f64,
    },
    /// The phase at the index is not within an electrical turn.
    IndexOffset {
        /// The offset in counts.
        offset: u32,
        /// Counts in an electrical turn.
        counts: f64,
    },
    /// The phase of a brushless motor turns too far in an instant.
    ElectricalSpeed {
        /// Electrical turns per second at the largest speed.
        turns: f64,
        /// The largest number that the modulation allows.
        largest: f64,
    },
    /// The bandwidth is larger than the modulation allows.
    Bandwidth {
        /// The bandwidth in Hz.
        bandwidth: f64,
        /// The largest in Hz.
        largest: f64,
    },
    /// No whole number of periods of the modulation fills a period of the servo.
    Period {
        /// The period of the servo in s.
        period: f64,
        /// The lowest frequency of the modulation in Hz.
        lowest: f64,
        /// The highest.
        highest: f64,
        /// The nearest possible period in s.
        nearest: f64,
    },
    /// Full-scale torque needs more current than the power stage can deliver.
    Current {
        /// Full-scale torque in N m.
        torque: f64,
        /// The current in A, including the margin to over-current.
        current: f64,
        /// The largest in A.
        largest: f64,
    },
    /// The supply is outside the board's range.
    Supply {
        /// The drive's.
        supply: SupplyRange,
        /// The board's.
        board: SupplyRange,
    },
    /// The voltage that the supply itself delivers is not within its range.
    OpenVoltage {
        /// The voltage in V.
        voltage: f64,
        /// The range.
        supply: SupplyRange,
    },
    /// The voltage is insufficient for the largest step at the largest speed.
    Voltage {
        /// The voltage needed, in V.
        needed: f64,
        /// The voltage available at the lowest supply, in V.
        available: f64,
        /// The lowest sufficient supply in V.
        enough: f64,
    },
    /// The largest temperature cannot be measured.
    Temperature {
        /// The temperature in degrees Celsius.
        temperature: f64,
        /// The lowest that can be measured.
        lowest: f64,
        /// The highest.
        highest: f64,
    },
    /// The converter's range ends below the largest current of the board.
    CurrentRange {
        /// The largest current in A.
        current: f64,
        /// The measured current in A, at the worst offset.
        largest: f64,
    },
}

impl DriveError {
    /// The error as a sentence, the same at compile time and later.
    pub const fn sentence(&self) -> Text<320> {
        let mut t = Text::new();
        match *self {
            Self::NotPositive { name, value } => {
                push!(t, "the " {name} " must be positive and finite, and is " {value});
            }
            Self::PolePairs { pole_pairs, largest } => push!(t,
                "the motor's " {pole_pairs} " pole pairs must be at least 1, and at most as many as leave an \
                 electrical turn 64 encoder counts, so that no torque is lost between two of them: " {largest}),
            Self::Counts { counts, largest } => push!(t,
                "a turn has " {counts} " encoder counts, and the phase of a brushless motor needs a whole number of \
                 them, up to " {largest} ": count at the shaft that the motor is on"),
            Self::IndexNotNeeded => t.push(
                "a brushed motor needs no index of its encoder: state none, or the winding of a brushless one",
            ),
            Self::IndexCounts { counts, least } => push!(t,
                "an electrical turn has " {counts} " encoder counts, and a phase that comes from the index needs at \
                 least " {least} ", since its pulse is some counts wide: take a finer encoder, or state no offset"),
            Self::IndexOffset { offset, counts } => push!(t,
                "the index offset of " {offset} " counts is not below the counts of an electrical turn, " {counts}
                ": align the motor, and state the offset that the board tells"),
            Self::ElectricalSpeed { turns, largest } => push!(t,
                "at the largest speed the motor makes " {turns} " electrical turns a second, and a 32nd of the \
                 modulation's frequency is " {largest} ": lower the largest speed"),
            Self::Bandwidth { bandwidth, largest } => push!(t,
                "the bandwidth of " {bandwidth} " Hz is above " {largest} " Hz, where the time constant of the \
                 current is two periods of the modulation: a faster one leaves the feedback no time"),
            Self::Period { period, lowest, highest, nearest } => push!(t,
                "the period of " {period} " s is not filled by whole periods of a modulation between " {lowest}
                " and " {highest} " Hz in whole counts of its timer: " {nearest} " s is"),
            Self::Current { torque, current, largest } => push!(t,
                "full-scale torque of " {torque} " N m, and the quarter more at which over-current trips, take "
                {current} " A, and the power stage measures and bears " {largest} " A: lower the full-scale torque"),
            Self::Supply { supply, board } => push!(t,
                "a supply from " {supply.lowest} " to " {supply.highest} " V is not in the board's range from "
                {board.lowest} " to " {board.highest} " V"),
            Self::OpenVoltage { voltage, supply } => push!(t,
                "the supply itself delivers up to " {voltage} " V, which must be between its lowest and its highest \
                 voltage, " {supply.lowest} " and " {supply.highest} " V"),
            Self::Voltage { needed, available, enough } => push!(t,
                "the step from full-scale torque to its opposite at the largest speed needs " {needed} " V at the \
                 motor, and the lowest supply gives " {available} " V: take " {enough}
                " V, or lower bandwidth, torque or speed"),
            Self::Temperature { temperature, lowest, highest } => push!(t,
                "the largest temperature of " {temperature} " degrees Celsius is not between " {lowest} " and "
                {highest}),
            Self::CurrentRange { current, largest } => push!(t,
                "the board's largest current of " {current} " A is above the " {largest}
                " A that its converter can measure"),
        }
        t
    }

    /// Rejects the first of these numbers that is not positive and finite.
    pub(super) const fn unless_positive(numbers: &[(&'static str, f64)]) -> Result<(), Self> {
        let mut i = 0;
        while i < numbers.len() {
            let (name, value) = numbers[i];
            if !(value > 0.0 && value.is_finite()) {
                return Err(Self::NotPositive { name, value });
            }
            i += 1;
        }
        Ok(())
    }
}

error_with_sentence!(DriveError);
