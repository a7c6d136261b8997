//! Faults of a power stage: its gates are switched off. Of a motor that could not be aligned, the reason.

use crate::fault::codes::fault_table;

fault_table! {
    /// The fault that switched a power stage off, with its numbers.
    PowerFault {
    /// The current of a phase was above the drive's limit: both in mA, without a sign.
    14 "over-current" OverCurrent { current: u32, largest: u32 } => (
        "a phase had {current} mA, and {largest} mA are allowed: check the motor's wires for a short circuit, then \
         arm again"),
    /// The supply was above its stated range, in mV.
    15 "over-voltage" OverVoltage { voltage: u32, highest: u32 } => (
        "the supply had {voltage} mV, and at most {highest} mV are allowed: lower it, or give it a brake resistor \
         for what the motor feeds back, then arm again"),
    /// The supply was below its stated range, in mV.
    16 "under-voltage" UnderVoltage { voltage: u32, lowest: u32 } => (
        "the supply had {voltage} mV, and at least {lowest} mV are needed: check it and its wires, then arm again"),
    /// The power stage was too hot, in tenths of a degree Celsius.
    17 "over-temperature" OverTemperature { temperature: i32, largest: i32 } => (
        "the power stage had {temperature} tenths of a degree Celsius, and {largest} are allowed: let it cool down, \
         then arm again"),
    /// The count of a phase (0 is U, 1 is V) without a current is that of a broken amplifier, or 0 for lack of
    /// samples.
    18 "current-offset" CurrentOffset { phase: u32, count: u32 } => (
        "the converter reads {count} for phase {} without a current, which no working amplifier gives: check the \
         power stage, then arm again", name(phase)),
    /// The current deviated from the certified model for too long, in mA.
    19 "current-not-following" CurrentNotFollowing { deviation: u32, largest: u32 } => (
        "the current was {deviation} mA off its model, and {largest} mA are allowed: check the motor's wires, and \
         its resistance and inductance, then arm again"),
    /// The supply's voltage was insufficient for more consecutive instants than allowed.
    20 "saturated-duty" SaturatedDuty { instants: u32, allowed: u32 } => (
        "the voltage was not enough for {instants} instants in a row, and {allowed} are allowed: the handle was \
         faster than its largest speed, or the motor has more resistance than was stated; arm again"),
    /// The index of the encoder was at a count within a turn other than at the alignment.
    21 "index-mismatch" IndexMismatch { count: u32, aligned: u32 } => (
        "the encoder's index was at the count {count}, and at {aligned} when the motor was aligned: check the \
         encoder's cable and coupling, then align again"),
    /// The current interrupt did not end before its compare values were loaded: in timer counts after the beginning
    /// of its period.
    22 "current-interrupt-late" CurrentInterruptLate { late: u32, allowed: u32 } => (
        "the currents' interrupt ended {late} timer counts after the start of its period, and {allowed} are \
         allowed: shorten the critical sections that mask it, then arm again"),
    /// A brushless motor has not been aligned, which the index of its encoder may be able to do.
    23 "not-aligned" NotAligned { by_index: bool } => (
        "the motor has not been aligned with its encoder: {}align it, then arm again",
        if by_index { "turn the handle past the encoder's index, or " } else { "" }),
    /// The converter's count of the thermistor is that of an open or of a shorted one, beyond the end of its range.
    29 "thermistor" Thermistor { count: u32, limit: u32 } => (
        "the converter reads {count} for the thermistor, and {limit} at the end of its range: it is disconnected or \
         shorted; repair it, then arm again"),
    /// The over-current comparator of a phase (0 is U, 1 is V, 2 is W) does not trip where a working one does without
    /// a current: the threshold in codes of its converter that did not separate the two outputs.
    30 "comparator" Comparator { phase: u32, threshold: u32 } => (
        "the over-current comparator of phase {} does not trip as a working one does without a current, at the \
         threshold {threshold}: keep the handle at rest, check the power stage, then arm again", name(phase)),
    /// The stated phase at the encoder's index is not that of the motor: counts that the handle moved by a current
    /// across and along the magnets.
    31 "index-offset" IndexOffset { across: i32, along: i32 } => (
        "a pulse of torque moved the handle by {across} counts, and a current without torque by {along}: keep the \
         hand off; if it comes again, the offset in the program is not this motor's: align it, and state the offset \
         that the board tells; then arm again"),
    others:
    /// The motor could not be aligned.
    Alignment(error: AlignmentError) => ("not aligned: "),
    }
}

fault_table! {
    /// The reason why a motor could not be aligned. Counts are per electrical turn.
    AlignmentError {
    /// The board cannot turn the motor's field: the motor is brushed, or behind an external amplifier.
    24 "alignment-not-needed" NotNeeded => (
        "this motor needs no alignment: it is brushed, or an amplifier outside turns its field"),
    /// The handle did not move by the counts of an electrical turn.
    25 "alignment-blocked" Blocked { moved: i32, expected: i32 } => (
        "the handle moved by {moved} counts, and an electrical turn has {expected}: release it, check the wires of \
         motor and encoder, then align again"),
    /// The handle moved, but not by an electrical turn.
    26 "alignment-pole-pairs" PolePairs { moved: i32, expected: i32 } => (
        "an electrical turn moved the handle by {moved} counts, and not by {expected}: check the pole pairs and the \
         counts per turn, keep the hand off, then align again"),
    /// The handle did not return by the counts that it moved.
    27 "alignment-not-returned" NotReturned { moved: i32, returned: i32 } => (
        "the handle moved by {moved} counts and back by {returned}: keep the hand off, check the encoder's \
         coupling, then align again"),
    /// The positions of the stops do not fit a turning field: the largest deviation in degrees of an electrical turn.
    28 "alignment-uneven" Uneven { degrees: i32, largest: i32 } => (
        "the handle settled {degrees} electrical degrees off the field, and {largest} are allowed: friction or \
         cogging is too much for the current of the alignment"),
    }
}

const fn name(phase: u32) -> &'static str {
    match phase {
        0 => "U",
        1 => "V",
        _ => "W",
    }
}
