//! Faults. They stop a servo: torque to zero, amplifier off, and a record.
//!
//! A fault is not a [limit reason](crate::torque::LimitReason), which is only the reason for a
//! reduced torque. After a fault the motor stays off until it is armed again.

mod record;

pub use record::FaultRecord;

use core::fmt;
use core::panic::PanicInfo;

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

    /// The fault in one word, for tables.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::MissedTick { .. } => "missed-tick",
            Self::EncoderJump { .. } => "encoder-jump",
            Self::NotANumber => "not-a-number",
            Self::LinkLost { .. } => "link-lost",
            Self::Watchdog => "watchdog",
            Self::Panic { .. } => "panic",
            Self::HardFault { .. } => "hard-fault",
            Self::LateTick { .. } => "late-tick",
            Self::ClockLost => "clock-lost",
            Self::FlashEcc { .. } => "flash-ecc",
            Self::RamParity => "ram-parity",
            Self::NonMaskable => "non-maskable",
            Self::Power(fault) => fault.as_str(),
        }
    }

    /// The fault as a code, never zero, and two numbers. Codes never change, so that hosts and boards of
    /// different versions understand each other; 4 was the code of a fault that no longer exists.
    pub const fn encode(self) -> (u32, [u32; 2]) {
        match self {
            Self::MissedTick { missed, tolerated } => (1, [missed, tolerated]),
            Self::EncoderJump { counts, largest } => (2, [counts, largest]),
            Self::NotANumber => (3, [0; 2]),
            Self::LinkLost { allowed } => (5, [allowed, 0]),
            Self::Watchdog => (6, [0; 2]),
            Self::Panic { line, column } => (7, [line, column]),
            Self::HardFault { address, status } => (8, [address, status]),
            Self::LateTick { late, allowed } => (9, [late, allowed]),
            Self::ClockLost => (10, [0; 2]),
            Self::FlashEcc { address, status } => (11, [address, status]),
            Self::RamParity => (12, [0; 2]),
            Self::NonMaskable => (13, [0; 2]),
            Self::Power(fault) => fault.encode(),
        }
    }

    /// The fault of a code and its numbers; `None` if there is no such fault.
    pub const fn decode(code: u32, numbers: [u32; 2]) -> Option<Self> {
        let [a, b] = numbers;
        Some(match code {
            1 => Self::MissedTick { missed: a, tolerated: b },
            2 => Self::EncoderJump { counts: a, largest: b },
            3 => Self::NotANumber,
            5 => Self::LinkLost { allowed: a },
            6 => Self::Watchdog,
            7 => Self::Panic { line: a, column: b },
            8 => Self::HardFault { address: a, status: b },
            9 => Self::LateTick { late: a, allowed: b },
            10 => Self::ClockLost,
            11 => Self::FlashEcc { address: a, status: b },
            12 => Self::RamParity,
            13 => Self::NonMaskable,
            _ => match PowerFault::decode(code, numbers) {
                Some(fault) => Self::Power(fault),
                None => return None,
            },
        })
    }
}

/// The event, the value, the bound, and the remedy.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MissedTick { missed, tolerated } => write!(
                f,
                "{missed} update(s) in a row were missed, and the certificate allows {tolerated}: \
                 lengthen the scene's period or its worst period, then arm again"
            ),
            Self::EncoderJump { counts, largest } => write!(
                f,
                "the encoder jumped by {counts} counts, and the device's largest speed allows \
                 {largest} in that time: check the encoder's cable and the largest speed, then \
                 reset with the device at its zero"
            ),
            Self::NotANumber => {
                f.write_str("NaN torque: send another set of parameters, then arm again")
            }
            Self::LinkLost { allowed } => write!(
                f,
                "the host was silent for more than the {allowed} ticks that are allowed: connect \
                 again, then arm again"
            ),
            Self::Watchdog => f.write_str(
                "the servo's interrupt stopped coming, and the watchdog reset the board: arm again",
            ),
            Self::Panic { line, column } => write!(
                f,
                "the program panicked at line {line}, column {column} of its source: this is a bug \
                 in the program; arm again"
            ),
            Self::HardFault { address, status } => write!(
                f,
                "hard fault at {address:#010x} with the status {status:#010x}: this is a bug in \
                 the program; arm again"
            ),
            Self::LateTick { late, allowed } => write!(
                f,
                "a tick began, or had its code, {late} timer counts after the start of its period, and \
                 {allowed} are allowed: shorten the critical sections that mask interrupts, or \
                 lengthen the scene's period, or its output delay where it has one, then arm again"
            ),
            Self::ClockLost => {
                f.write_str("the crystal stopped: check it and its supply, then arm again")
            }
            Self::FlashEcc { address, status } => write!(
                f,
                "uncorrectable flash error at {address:#010x} of its bank (error register: \
                 {status:#010x}): flash the program again, then arm again"
            ),
            Self::RamParity => f.write_str("RAM parity error: check the supply, then arm again"),
            Self::NonMaskable => f.write_str(
                "a non-maskable interrupt came, and the chip does not report its cause: arm again",
            ),
            Self::Power(fault) => write!(f, "{fault}"),
        }
    }
}

impl core::error::Error for Fault {}

#[cfg(test)]
mod tests;
