//! Why a board cannot be switched on, or cannot go on.

use std::fmt;

use crate::peripheral::Unmodelled;

/// Why a board cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoardError {
    /// The program uses a feature that is not modelled.
    #[error("{what}; instruction {now} at {address:#010x}")]
    NotModelled {
        /// What.
        what: NotModelled,
        /// When.
        now: u64,
        /// Where.
        address: u32,
    },
    /// The core is locked up: a fault where none can be served, and no watchdog to reset it.
    #[error(
        "the core is locked up by a fault within a fault, and there is no watchdog; \
         instruction {now} at {address:#010x}"
    )]
    LockedUp {
        /// When.
        now: u64,
        /// Where.
        address: u32,
    },
    /// The program wants its debugger.
    #[error("the core is stopped by a breakpoint; instruction {now} at {address:#010x}")]
    Breakpoint {
        /// When.
        now: u64,
        /// Where.
        address: u32,
    },
    /// Both switches of a leg of the power stage were on.
    #[error("both switches of leg {leg} of the power stage were on; instruction {now}")]
    ShootThrough {
        /// When.
        now: u64,
        /// Which: 0 is phase U.
        leg: usize,
    },
    /// The clock stands still, and there is no watchdog.
    #[error("the core's clock has stopped, and there is no watchdog; instruction {now}")]
    NoClock {
        /// When.
        now: u64,
    },
    /// What was waited for did not come.
    #[error("{what} has not happened within {instructions} instructions")]
    Late {
        /// What was waited for.
        what: &'static str,
        /// How long.
        instructions: u64,
    },
}

/// Why there is no board.
#[derive(Debug, thiserror::Error)]
pub enum BootError {
    /// The program's file could not be read.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// It is not a program.
    #[error("{path}: {source}")]
    Image {
        /// The file.
        path: String,
        /// Why.
        source: object::Error,
    },
    /// It is not for this chip's memory.
    #[error("the program has {size} bytes at {address:#010x}, where the chip has no flash")]
    NoFlash {
        /// Where.
        address: u32,
        /// How many.
        size: usize,
    },
}

/// Something that is not modelled was used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotModelled {
    /// Name of the unit; none where nothing is at the address.
    pub unit: Option<&'static str>,
    /// The register's name, where it has one.
    pub register: Option<&'static str>,
    /// The address.
    pub address: u32,
    /// What was written, if it was.
    pub written: Option<u32>,
    /// Why it is not.
    pub why: AccessError,
}

/// Why an access fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccessError {
    /// Nothing of the virtual board is there.
    Nobody,
    /// The unit is, but not this register or these bits.
    Unit(Unmodelled),
    /// The unit's clock is off, or the unit is held in reset.
    Stopped,
    /// Such an access (by bytes) is not.
    Width,
    /// A converter has sampled a channel that nothing drives.
    Floating,
}

impl fmt::Display for NotModelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.unit.unwrap_or("nothing that is modelled");
        match self.written {
            Some(value) => write!(f, "the program wrote {value:#010x} to ")?,
            None => f.write_str("the program read ")?,
        }
        match self.register {
            Some(register) => write!(f, "{register} of {unit} at {:#010x}: ", self.address)?,
            None => write!(f, "{:#010x}, in {unit}: ", self.address)?,
        }
        match self.why {
            AccessError::Nobody => f.write_str("the virtual board has no peripheral there"),
            AccessError::Unit(Unmodelled::Register) => f.write_str("that register is not modelled"),
            AccessError::Unit(Unmodelled::Bits(bits)) => {
                write!(f, "the bits {bits:#010x} are not modelled in that register")
            }
            AccessError::Stopped => f.write_str("its clock is off, or it is held in reset"),
            AccessError::Floating => f.write_str("it has sampled a channel that nothing drives"),
            AccessError::Width => f.write_str("an access of that width is not modelled"),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::board::VirtualBoard;
    use crate::chip::{Chip, NUCLEO_G474RE};
    use crate::device::FixedDevice;

    /// The error of a program that reads there, or writes this.
    fn said(address: u32, written: Option<u32>) -> String {
        let mut board = VirtualBoard::new(&NUCLEO_G474RE, Box::new(FixedDevice));
        // TIM6 and USART2 are clocked, and nothing else of their bus.
        board.write(0x4002_1058, 4, (1 << 4) | (1 << 17));
        match written {
            Some(value) => board.write(address, 4, value),
            None => drop(board.read(address, 4)),
        }
        board.stopped.expect("it is not modelled").to_string()
    }

    #[test]
    fn what_is_not_modelled_is_named() {
        for (sentence, parts) in [
            (said(0x4000_1024, None), ["CNT of TIM6 at 0x40001024", "not modelled"]),
            (said(0x4000_1000, Some(0x81)), ["CR1 of TIM6", "bits 0x00000080"]),
            (said(0x4000_4418, Some(1)), ["wrote 0x00000001 to RQR of USART2", "not modelled"]),
            (said(0x4000_0024, None), ["CNT of TIM2", "its clock is off"]),
            (said(0x4002_0000, None), ["0x40020000", "no peripheral there"]),
            (said(0xE000_EF00, Some(3)), ["0xe000ef00, in the system control space", "not"]),
        ] {
            assert!(parts.iter().all(|part| sentence.contains(part)), "{sentence}");
        }
    }

    #[test]
    fn registers_of_both_chips_have_names() {
        for chip in Chip::ALL {
            for place in chip.map {
                assert!((chip.names)(place.unit, 0).is_some(), "{}: {}", chip.name, place.name);
            }
        }
    }
}
