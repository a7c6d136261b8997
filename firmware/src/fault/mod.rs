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

/// A fault with its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// More updates were missed than the certificate tolerates: a tick came late, or ended after
    /// its update.
    MissedTick {
        /// Consecutive missed updates.
        missed: u32,
        /// Consecutive updates that may be missed under the certificate's worst period.
        tolerated: u32,
    },
    /// The encoder moved further than the device can move.
    EncoderJump {
        /// The motion in counts, without its sign.
        counts: u32,
        /// The largest motion in counts in this time at the device's largest speed.
        largest: u32,
    },
    /// The torque was not a number.
    NotANumber,
    /// The host has been silent for too long.
    LinkLost {
        /// Allowed ticks without a message.
        allowed: u32,
    },
    /// The servo's interrupt stopped, and the watchdog reset the chip.
    Watchdog,
    /// The program panicked.
    Panic {
        /// Line of the source.
        line: u32,
        /// Column of the source.
        column: u32,
    },
    /// The processor raised a hard fault.
    HardFault {
        /// Program counter.
        address: u32,
        /// The processor's configurable fault status.
        status: u32,
    },
    /// A tick began later in its period than the certificate allows for its count, or its code was not ready
    /// at the time of the output.
    LateTick {
        /// Timer counts after the beginning of its period.
        late: u32,
        /// The largest allowed value.
        allowed: u32,
    },
    /// The crystal of the core's clock has stopped.
    ClockLost,
    /// A word of the flash memory has more wrong bits than the error correction can repair.
    FlashEcc {
        /// The word's place in its bank of the flash memory, in bytes.
        address: u32,
        /// The content of the memory's error register.
        status: u32,
    },
    /// A word of RAM has a wrong parity.
    RamParity,
    /// A non-maskable interrupt without a cause in the chip's registers.
    NonMaskable,
    /// A fault of the board's bridge, or of its motor.
    Power(PowerFault),
}

impl Fault {
    /// The fault of a panic, for a panic handler.
    pub fn of_panic(info: &PanicInfo<'_>) -> Self {
        let (line, column) = info.location().map_or((0, 0), |at| (at.line(), at.column()));
        Self::Panic { line, column }
    }
}

// 4 was the code of a fault that no longer exists; from 14 on codes are those of a power stage.
fault_table! { Fault {
    1 "missed-tick" MissedTick { missed, tolerated } => (
        "{missed} update(s) in a row were missed, and the certificate allows {tolerated}: lengthen the scene's \
         period or its worst period, then arm again"),
    2 "encoder-jump" EncoderJump { counts, largest } => (
        "the encoder jumped by {counts} counts, and the device's largest speed allows {largest} in that time: check \
         the encoder's cable and the largest speed, then reset with the device at its zero"),
    3 "not-a-number" NotANumber => ("NaN torque: send another set of parameters, then arm again"),
    5 "link-lost" LinkLost { allowed } => (
        "the host was silent for more than the {allowed} ticks that are allowed: connect again, then arm again"),
    6 "watchdog" Watchdog => (
        "the servo's interrupt stopped coming, and the watchdog reset the board: arm again"),
    7 "panic" Panic { line, column } => (
        "the program panicked at line {line}, column {column} of its source: this is a bug in the program; arm \
         again"),
    8 "hard-fault" HardFault { address, status } => (
        "hard fault at {address:#010x} with the status {status:#010x}: this is a bug in the program; arm again"),
    9 "late-tick" LateTick { late, allowed } => (
        "a tick began, or had its code, {late} timer counts after the start of its period, and {allowed} are \
         allowed: shorten the critical sections that mask interrupts, or lengthen the scene's period, or its output \
         delay where it has one, then arm again"),
    10 "clock-lost" ClockLost => ("the crystal stopped: check it and its supply, then arm again"),
    11 "flash-ecc" FlashEcc { address, status } => (
        "uncorrectable flash error at {address:#010x} of its bank (error register: {status:#010x}): flash the \
         program again, then arm again"),
    12 "ram-parity" RamParity => ("RAM parity error: check the supply, then arm again"),
    13 "non-maskable" NonMaskable => (
        "a non-maskable interrupt came, and the chip does not report its cause: arm again"),
    _ Power(fault: PowerFault) => (""),
} }

#[cfg(test)]
mod tests;
