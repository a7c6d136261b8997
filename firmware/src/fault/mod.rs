//! Faults. They stop a servo: torque to zero, amplifier off, and a record.
//!
//! A fault is not a [limit reason](crate::torque::LimitReason), which is only the reason for a
//! reduced torque. After a fault the motor stays off until it is armed again.

pub(crate) mod codes;
mod record;

pub use record::FaultRecord;

use core::panic::PanicInfo;

use codes::fault_table;

use crate::current::PowerFault;
use crate::magnetic::ReadingError;

// 4 was the code of a fault that no longer exists; codes from 14 to 31 are those of a power stage.
fault_table! {
    /// A fault with its numbers.
    Fault {
    /// More updates in a row were missed than the certificate's worst period tolerates: a tick came late, or ended
    /// after its update.
    1 "missed-tick" MissedTick { missed: u32, tolerated: u32 } => (
        "{missed} update(s) in a row were missed, and the certificate allows {tolerated}: lengthen the scene's \
         period or its worst period, then arm again"),
    /// The encoder moved by more counts than the device can in this time at its largest speed.
    2 "encoder-jump" EncoderJump { counts: u32, largest: u32 } => (
        "the encoder jumped by {counts} counts, and the device's largest speed allows {largest} in that time: check \
         the encoder's cable and the largest speed, then reset with the device at its zero"),
    /// The torque was not a number.
    3 "not-a-number" NotANumber => ("NaN torque: send another set of parameters, then arm again"),
    /// The host has been silent for more than the allowed ticks.
    5 "link-lost" LinkLost { allowed: u32 } => (
        "the host was silent for more than the {allowed} ticks that are allowed: connect again, then arm again"),
    /// The servo's interrupt stopped, and the watchdog reset the chip.
    6 "watchdog" Watchdog => (
        "the servo's interrupt stopped coming, and the watchdog reset the board: arm again"),
    /// The program panicked at this line and column of its source.
    7 "panic" Panic { line: u32, column: u32 } => (
        "the program panicked at line {line}, column {column} of its source: this is a bug in the program; arm \
         again"),
    /// The processor raised a hard fault: the program counter, and the configurable fault status.
    8 "hard-fault" HardFault { address: u32, status: u32 } => (
        "hard fault at {address:#010x} with the status {status:#010x}: this is a bug in the program; arm again"),
    /// A tick began later in its period than the certificate allows for its count, or its code was not ready
    /// at the time of the output, in timer counts after the beginning of the period.
    9 "late-tick" LateTick { late: u32, allowed: u32 } => (
        "a tick began, or had its code, {late} timer counts after the start of its period, and {allowed} are \
         allowed: shorten the critical sections that mask interrupts, or lengthen the scene's period, or its output \
         delay where it has one, then arm again"),
    /// The crystal of the core's clock has stopped.
    10 "clock-lost" ClockLost => ("the crystal stopped: check it and its supply, then arm again"),
    /// A word of the flash memory has more wrong bits than the error correction can repair: its place in its bank
    /// in bytes, and the memory's error register.
    11 "flash-ecc" FlashEcc { address: u32, status: u32 } => (
        "uncorrectable flash error at {address:#010x} of its bank (error register: {status:#010x}): flash the \
         program again, then arm again"),
    /// A word of RAM has a wrong parity.
    12 "ram-parity" RamParity => ("RAM parity error: check the supply, then arm again"),
    /// A non-maskable interrupt without a cause in the chip's registers.
    13 "non-maskable" NonMaskable => (
        "a non-maskable interrupt came, and the chip does not report its cause: arm again"),
    /// More readings of a magnetic encoder in a row failed than the scene allows, or it has stopped: the number of the
    /// last one's [error](ReadingError), and how many may fail.
    32 "encoder-reading" EncoderReading { error: u32, allowed: u32 } => (
        "the readings of the encoder failed more than {allowed} times in a row, the last because {}: check its wires, \
         its supply and its magnet, then reset the board", reason(error)),
    others:
    /// A fault of the board's bridge, or of its motor.
    Power(fault: PowerFault) => (""),
    }
}

/// The reason of a failed reading by its number.
fn reason(error: u32) -> &'static str {
    ReadingError::ALL.get(error as usize).map_or("of an unknown error", |error| error.as_str())
}

impl Fault {
    /// The fault of a panic, for a panic handler.
    pub fn of_panic(info: &PanicInfo<'_>) -> Self {
        let (line, column) = info.location().map_or((0, 0), |at| (at.line(), at.column()));
        Self::Panic { line, column }
    }
}

#[cfg(test)]
mod tests;
