//! Faults of a power stage: its gates are switched off.

use core::fmt;

use super::alignment_error::AlignmentError;

/// The fault that switched a power stage off, with its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerFault {
    /// The current of a phase was above the drive's limit.
    OverCurrent {
        /// The current in mA, without its sign.
        current: u32,
        /// The largest in mA.
        largest: u32,
    },
    /// The supply was above its stated range.
    OverVoltage {
        /// The voltage in mV.
        voltage: u32,
        /// The highest in mV.
        highest: u32,
    },
    /// The supply was below its stated range.
    UnderVoltage {
        /// The voltage in mV.
        voltage: u32,
        /// The lowest in mV.
        lowest: u32,
    },
    /// The power stage was too hot.
    OverTemperature {
        /// The temperature in tenths of a degree Celsius.
        temperature: i32,
        /// The largest, in tenths of a degree Celsius.
        largest: i32,
    },
    /// The converter's count of the thermistor is that of an open or of a shorted one.
    Thermistor {
        /// The count.
        count: u32,
        /// The count at the end of the thermistor's range.
        limit: u32,
    },
    /// A comparator of the over-current protection does not trip where a working one does without a current.
    Comparator {
        /// The phase: 0 is U, 1 is V, 2 is W.
        phase: u32,
        /// The threshold in codes of its converter that did not separate the two outputs.
        threshold: u32,
    },
    /// The stated phase at the encoder's index is not that of the motor: the handle did not move as its torque.
    IndexOffset {
        /// Counts that it moved by a current across the magnets.
        across: i32,
        /// Counts that it moved by a current along them.
        along: i32,
    },
    /// The count of a phase without a current is that of a broken amplifier, or was not measured.
    CurrentOffset {
        /// The phase: 0 is U, 1 is V.
        phase: u32,
        /// Its count, 0 if there are not enough samples.
        count: u32,
    },
    /// The current deviated from the certified model for too long.
    CurrentNotFollowing {
        /// The deviation in mA.
        deviation: u32,
        /// The largest allowed deviation in mA.
        largest: u32,
    },
    /// The supply's voltage was insufficient for too long.
    SaturatedDuty {
        /// Consecutive instants with insufficient voltage.
        instants: u32,
        /// The largest allowed number.
        allowed: u32,
    },
    /// The index of the encoder was at a count other than at the alignment.
    IndexMismatch {
        /// The count, within a turn.
        count: u32,
        /// The count at the alignment.
        aligned: u32,
    },
    /// The current interrupt did not end before its compare values were loaded.
    CurrentInterruptLate {
        /// Timer counts after the beginning of its period.
        late: u32,
        /// The most that is allowed.
        allowed: u32,
    },
    /// A brushless motor has not been aligned.
    NotAligned {
        /// Whether the index of its encoder can align it.
        by_index: bool,
    },
    /// The motor could not be aligned.
    Alignment(AlignmentError),
}

impl PowerFault {
    /// The fault in one word, for tables.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::OverCurrent { .. } => "over-current",
            Self::OverVoltage { .. } => "over-voltage",
            Self::UnderVoltage { .. } => "under-voltage",
            Self::OverTemperature { .. } => "over-temperature",
            Self::CurrentOffset { .. } => "current-offset",
            Self::Thermistor { .. } => "thermistor",
            Self::Comparator { .. } => "comparator",
            Self::IndexOffset { .. } => "index-offset",
            Self::CurrentNotFollowing { .. } => "current-not-following",
            Self::SaturatedDuty { .. } => "saturated-duty",
            Self::IndexMismatch { .. } => "index-mismatch",
            Self::CurrentInterruptLate { .. } => "current-interrupt-late",
            Self::NotAligned { .. } => "not-aligned",
            Self::Alignment(error) => error.as_str(),
        }
    }

    /// The fault as a code and two numbers, distinct from the codes of [`Fault`](crate::fault::Fault).
    pub const fn encode(self) -> (u32, [u32; 2]) {
        match self {
            Self::OverCurrent { current, largest } => (14, [current, largest]),
            Self::OverVoltage { voltage, highest } => (15, [voltage, highest]),
            Self::UnderVoltage { voltage, lowest } => (16, [voltage, lowest]),
            Self::OverTemperature { temperature, largest } => {
                (17, [temperature.cast_unsigned(), largest.cast_unsigned()])
            }
            Self::CurrentOffset { phase, count } => (18, [phase, count]),
            Self::CurrentNotFollowing { deviation, largest } => (19, [deviation, largest]),
            Self::SaturatedDuty { instants, allowed } => (20, [instants, allowed]),
            Self::IndexMismatch { count, aligned } => (21, [count, aligned]),
            Self::CurrentInterruptLate { late, allowed } => (22, [late, allowed]),
            Self::NotAligned { by_index } => (23, [by_index as u32, 0]),
            Self::Alignment(error) => error.encode(),
            Self::Thermistor { count, limit } => (29, [count, limit]),
            Self::Comparator { phase, threshold } => (30, [phase, threshold]),
            Self::IndexOffset { across, along } => {
                (31, [across.cast_unsigned(), along.cast_unsigned()])
            }
        }
    }

    /// The fault of a code and its numbers; `None` if there is no such fault of a power stage.
    pub const fn decode(code: u32, numbers: [u32; 2]) -> Option<Self> {
        let [a, b] = numbers;
        Some(match code {
            14 => Self::OverCurrent { current: a, largest: b },
            15 => Self::OverVoltage { voltage: a, highest: b },
            16 => Self::UnderVoltage { voltage: a, lowest: b },
            17 => Self::OverTemperature { temperature: a.cast_signed(), largest: b.cast_signed() },
            18 => Self::CurrentOffset { phase: a, count: b },
            19 => Self::CurrentNotFollowing { deviation: a, largest: b },
            20 => Self::SaturatedDuty { instants: a, allowed: b },
            21 => Self::IndexMismatch { count: a, aligned: b },
            22 => Self::CurrentInterruptLate { late: a, allowed: b },
            23 => Self::NotAligned { by_index: a != 0 },
            29 => Self::Thermistor { count: a, limit: b },
            30 => Self::Comparator { phase: a, threshold: b },
            31 => Self::IndexOffset { across: a.cast_signed(), along: b.cast_signed() },
            _ => match AlignmentError::decode(code, numbers) {
                Some(error) => Self::Alignment(error),
                None => return None,
            },
        })
    }
}

/// The name of a phase.
const fn name(phase: u32) -> &'static str {
    match phase {
        0 => "U",
        1 => "V",
        _ => "W",
    }
}

/// The event, the value, the bound, and the remedy.
impl fmt::Display for PowerFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OverCurrent { current, largest } => write!(
                f,
                "a phase had {current} mA, and {largest} mA are allowed: check the motor's wires for a \
                 short circuit, then arm again"
            ),
            Self::OverVoltage { voltage, highest } => write!(
                f,
                "the supply had {voltage} mV, and at most {highest} mV are allowed: lower it, or give it a \
                 brake resistor for what the motor feeds back, then arm again"
            ),
            Self::UnderVoltage { voltage, lowest } => write!(
                f,
                "the supply had {voltage} mV, and at least {lowest} mV are needed: check it and its wires, \
                 then arm again"
            ),
            Self::OverTemperature { temperature, largest } => write!(
                f,
                "the power stage had {temperature} tenths of a degree Celsius, and {largest} are allowed: \
                 let it cool down, then arm again"
            ),
            Self::CurrentOffset { phase, count } => write!(
                f,
                "the converter reads {count} for phase {} without a current, which no working amplifier \
                 gives: check the power stage, then arm again",
                name(*phase)
            ),
            Self::IndexOffset { across, along } => write!(
                f,
                "a pulse of torque moved the handle by {across} counts, and a current without torque by \
                 {along}: keep the hand off; if it comes again, the offset in the program is not this motor's: \
                 align it, and state the offset that the board tells; then arm again"
            ),
            Self::Thermistor { count, limit } => write!(
                f,
                "the converter reads {count} for the thermistor, and {limit} at the end of its range: it is \
                 disconnected or shorted; repair it, then arm again"
            ),
            Self::Comparator { phase, threshold } => write!(
                f,
                "the over-current comparator of phase {} does not trip as a working one does without a \
                 current, at the threshold {threshold}: keep the handle at rest, check the power stage, then \
                 arm again",
                name(*phase)
            ),
            Self::CurrentNotFollowing { deviation, largest } => write!(
                f,
                "the current was {deviation} mA off its model, and {largest} mA are allowed: check the \
                 motor's wires, and its resistance and inductance, then arm again"
            ),
            Self::SaturatedDuty { instants, allowed } => write!(
                f,
                "the voltage was not enough for {instants} instants in a row, and {allowed} are allowed: the \
                 handle was faster than its largest speed, or the motor has more resistance than was \
                 stated; arm again"
            ),
            Self::IndexMismatch { count, aligned } => write!(
                f,
                "the encoder's index was at the count {count}, and at {aligned} when the motor was aligned: \
                 check the encoder's cable and coupling, then align again"
            ),
            Self::CurrentInterruptLate { late, allowed } => write!(
                f,
                "the currents' interrupt ended {late} timer counts after the start of its period, and \
                 {allowed} are allowed: shorten the critical sections that mask it, then arm again"
            ),
            Self::Alignment(error) => write!(f, "not aligned: {error}"),
            Self::NotAligned { by_index: false } => f.write_str(
                "the motor has not been aligned with its encoder: align it, then arm again",
            ),
            Self::NotAligned { by_index: true } => f.write_str(
                "the motor has not been aligned with its encoder: turn the handle past the encoder's index, \
                 or align it, then arm again",
            ),
        }
    }
}

impl core::error::Error for PowerFault {}
