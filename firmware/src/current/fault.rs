//! Faults of a power stage: its gates are switched off. Of a motor that could not be aligned, the reason.

use crate::fault::codes::fault_table;

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

/// The reason why a motor could not be aligned. Counts are per electrical turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlignmentError {
    /// The board cannot turn the motor's field: the motor is brushed, or behind an external amplifier.
    NotNeeded,
    /// The handle did not move.
    Blocked {
        /// Counts that it moved.
        moved: i32,
        /// Counts of an electrical turn.
        expected: i32,
    },
    /// The handle moved, but not by an electrical turn.
    PolePairs {
        /// Counts that it moved.
        moved: i32,
        /// Counts of an electrical turn.
        expected: i32,
    },
    /// The handle did not return by the same number of counts.
    NotReturned {
        /// Counts that it moved.
        moved: i32,
        /// Counts that it moved back.
        returned: i32,
    },
    /// The positions of the stops do not fit a turning field.
    Uneven {
        /// The largest deviation in degrees of an electrical turn.
        degrees: i32,
        /// The largest allowed deviation.
        largest: i32,
    },
}

fault_table! { PowerFault {
    14 "over-current" OverCurrent { current, largest } => (
        "a phase had {current} mA, and {largest} mA are allowed: check the motor's wires for a short circuit, then \
         arm again"),
    15 "over-voltage" OverVoltage { voltage, highest } => (
        "the supply had {voltage} mV, and at most {highest} mV are allowed: lower it, or give it a brake resistor \
         for what the motor feeds back, then arm again"),
    16 "under-voltage" UnderVoltage { voltage, lowest } => (
        "the supply had {voltage} mV, and at least {lowest} mV are needed: check it and its wires, then arm again"),
    17 "over-temperature" OverTemperature { temperature, largest } => (
        "the power stage had {temperature} tenths of a degree Celsius, and {largest} are allowed: let it cool down, \
         then arm again"),
    18 "current-offset" CurrentOffset { phase, count } => (
        "the converter reads {count} for phase {} without a current, which no working amplifier gives: check the \
         power stage, then arm again", name(phase)),
    19 "current-not-following" CurrentNotFollowing { deviation, largest } => (
        "the current was {deviation} mA off its model, and {largest} mA are allowed: check the motor's wires, and \
         its resistance and inductance, then arm again"),
    20 "saturated-duty" SaturatedDuty { instants, allowed } => (
        "the voltage was not enough for {instants} instants in a row, and {allowed} are allowed: the handle was \
         faster than its largest speed, or the motor has more resistance than was stated; arm again"),
    21 "index-mismatch" IndexMismatch { count, aligned } => (
        "the encoder's index was at the count {count}, and at {aligned} when the motor was aligned: check the \
         encoder's cable and coupling, then align again"),
    22 "current-interrupt-late" CurrentInterruptLate { late, allowed } => (
        "the currents' interrupt ended {late} timer counts after the start of its period, and {allowed} are \
         allowed: shorten the critical sections that mask it, then arm again"),
    23 "not-aligned" NotAligned { by_index } => (
        "the motor has not been aligned with its encoder: {}align it, then arm again",
        if by_index { "turn the handle past the encoder's index, or " } else { "" }),
    29 "thermistor" Thermistor { count, limit } => (
        "the converter reads {count} for the thermistor, and {limit} at the end of its range: it is disconnected or \
         shorted; repair it, then arm again"),
    30 "comparator" Comparator { phase, threshold } => (
        "the over-current comparator of phase {} does not trip as a working one does without a current, at the \
         threshold {threshold}: keep the handle at rest, check the power stage, then arm again", name(phase)),
    31 "index-offset" IndexOffset { across, along } => (
        "a pulse of torque moved the handle by {across} counts, and a current without torque by {along}: keep the \
         hand off; if it comes again, the offset in the program is not this motor's: align it, and state the offset \
         that the board tells; then arm again"),
    _ Alignment(error: AlignmentError) => ("not aligned: "),
} }

fault_table! { AlignmentError {
    24 "alignment-not-needed" NotNeeded => (
        "this motor needs no alignment: it is brushed, or an amplifier outside turns its field"),
    25 "alignment-blocked" Blocked { moved, expected } => (
        "the handle moved by {moved} counts, and an electrical turn has {expected}: release it, check the wires of \
         motor and encoder, then align again"),
    26 "alignment-pole-pairs" PolePairs { moved, expected } => (
        "an electrical turn moved the handle by {moved} counts, and not by {expected}: check the pole pairs and the \
         counts per turn, keep the hand off, then align again"),
    27 "alignment-not-returned" NotReturned { moved, returned } => (
        "the handle moved by {moved} counts and back by {returned}: keep the hand off, check the encoder's \
         coupling, then align again"),
    28 "alignment-uneven" Uneven { degrees, largest } => (
        "the handle settled {degrees} electrical degrees off the field, and {largest} are allowed: friction or \
         cogging is too much for the current of the alignment"),
} }

/// The name of a phase.
const fn name(phase: u32) -> &'static str {
    match phase {
        0 => "U",
        1 => "V",
        _ => "W",
    }
}
