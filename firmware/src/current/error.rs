//! Reasons why a drive cannot run on a power stage.

use core::fmt;

use super::motor::SupplyRange;
use crate::text::Text;

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

/// A sentence about a drive.
type DriveSentence = Text<320>;

impl DriveError {
    /// The error as a sentence, the same at compile time and later.
    pub const fn sentence(&self) -> DriveSentence {
        let mut t = DriveSentence::new();
        match self {
            Self::NotPositive { name, value } => {
                t.push("the ");
                t.push(name);
                t.push(" must be positive and finite, and is ");
                t.push_number(*value);
            }
            Self::PolePairs { pole_pairs, largest } => {
                t.push("the motor's ");
                t.push_number(*pole_pairs as f64);
                t.push(
                    " pole pairs must be at least 1, and at most as many as leave an electrical turn 64 \
                     encoder counts, so that no torque is lost between two of them: ",
                );
                t.push_number(*largest as f64);
            }
            Self::Counts { counts, largest } => {
                t.push("a turn has ");
                t.push_number(*counts);
                t.push(
                    " encoder counts, and the phase of a brushless motor needs a whole number of them, up to ",
                );
                t.push_number(*largest);
                t.push(": count at the shaft that the motor is on");
            }
            Self::IndexNotNeeded => t.push(
                "a brushed motor needs no index of its encoder: state none, or the winding of a brushless one",
            ),
            Self::IndexCounts { counts, least } => {
                t.push("an electrical turn has ");
                t.push_number(*counts);
                t.push(" encoder counts, and a phase that comes from the index needs at least ");
                t.push_number(*least);
                t.push(", since its pulse is some counts wide: take a finer encoder, or state no offset");
            }
            Self::IndexOffset { offset, counts } => {
                t.push("the index offset of ");
                t.push_number(*offset as f64);
                t.push(" counts is not below the counts of an electrical turn, ");
                t.push_number(*counts);
                t.push(": align the motor, and state the offset that the board tells");
            }
            Self::ElectricalSpeed { turns, largest } => {
                t.push("at the largest speed the motor makes ");
                t.push_number(*turns);
                t.push(" electrical turns a second, and a 32nd of the modulation's frequency is ");
                t.push_number(*largest);
                t.push(": lower the largest speed");
            }
            Self::Bandwidth { bandwidth, largest } => {
                t.push("the bandwidth of ");
                t.push_number(*bandwidth);
                t.push(" Hz is above ");
                t.push_number(*largest);
                t.push(
                    " Hz, where the time constant of the current is two periods of the modulation: a \
                     faster one leaves the feedback no time",
                );
            }
            Self::Period { period, lowest, highest, nearest } => {
                t.push("the period of ");
                t.push_number(*period);
                t.push(" s is not filled by whole periods of a modulation between ");
                t.push_number(*lowest);
                t.push(" and ");
                t.push_number(*highest);
                t.push(" Hz in whole counts of its timer: ");
                t.push_number(*nearest);
                t.push(" s is");
            }
            Self::Current { torque, current, largest } => {
                t.push("full-scale torque of ");
                t.push_number(*torque);
                t.push(" N m, and the quarter more at which over-current trips, take ");
                t.push_number(*current);
                t.push(" A, and the power stage measures and bears ");
                t.push_number(*largest);
                t.push(" A: lower the full-scale torque");
            }
            Self::Supply { supply, board } => {
                t.push("a supply from ");
                t.push_number(supply.lowest);
                t.push(" to ");
                t.push_number(supply.highest);
                t.push(" V is not in the board's range from ");
                t.push_number(board.lowest);
                t.push(" to ");
                t.push_number(board.highest);
                t.push(" V");
            }
            Self::OpenVoltage { voltage, supply } => {
                t.push("the supply itself delivers up to ");
                t.push_number(*voltage);
                t.push(" V, which must be between its lowest and its highest voltage, ");
                t.push_number(supply.lowest);
                t.push(" and ");
                t.push_number(supply.highest);
                t.push(" V");
            }
            Self::Voltage { needed, available, enough } => {
                t.push(
                    "the step from full-scale torque to its opposite at the largest speed needs ",
                );
                t.push_number(*needed);
                t.push(" V at the motor, and the lowest supply gives ");
                t.push_number(*available);
                t.push(" V: take ");
                t.push_number(*enough);
                t.push(" V, or lower bandwidth, torque or speed");
            }
            Self::Temperature { temperature, lowest, highest } => {
                t.push("the largest temperature of ");
                t.push_number(*temperature);
                t.push(" degrees Celsius is not between ");
                t.push_number(*lowest);
                t.push(" and ");
                t.push_number(*highest);
            }
            Self::CurrentRange { current, largest } => {
                t.push("the board's largest current of ");
                t.push_number(*current);
                t.push(" A is above the ");
                t.push_number(*largest);
                t.push(" A that its converter can measure");
            }
        }
        t
    }

    /// Rejects values that are not positive and finite.
    pub(super) const fn unless_positive(name: &'static str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotPositive { name, value })
        }
    }

    /// Panics with the error's text; in a constant this is a compile error.
    #[track_caller]
    pub(super) const fn refuse(&self) -> ! {
        panic!("{}", self.sentence().as_str())
    }
}

impl fmt::Display for DriveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence().as_str())
    }
}

impl core::error::Error for DriveError {}
