//! The reasons why a board cannot boot or cannot continue.

use std::fmt;

use crate::peripheral::Unmodelled;

/// The reason why a board cannot continue.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum BoardError {
    /// The program uses a feature that is not modelled.
    #[error("{what}; instruction {now} at {address:#010x}")]
    NotModelled { what: NotModelled, now: u64, address: u32 },
    /// The core is locked up: a fault that cannot be served, and no watchdog to reset it.
    #[error(
        "the core is locked up by a fault within a fault, and there is no watchdog; \
         instruction {now} at {address:#010x}"
    )]
    LockedUp { now: u64, address: u32 },
    /// The program has a breakpoint.
    #[error("the core is stopped by a breakpoint; instruction {now} at {address:#010x}")]
    Breakpoint { now: u64, address: u32 },
    /// Both switches of a leg of the power stage were on.
    #[error("both switches of leg {leg} of the power stage were on; instruction {now}")]
    ShootThrough { now: u64, leg: usize },
    /// The clock has stopped, and there is no watchdog.
    #[error("the core's clock has stopped, and there is no watchdog; instruction {now}")]
    NoClock { now: u64 },
    /// An expected event did not occur.
    #[error("{what} has not happened within {instructions} instructions")]
    Late { what: &'static str, instructions: u64 },
}

/// The reason why a board cannot boot.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum BootError {
    /// The program's file could not be read.
    #[error("{path}: {source}")]
    File { path: String, source: std::io::Error },
    /// The file is not a program.
    #[error("{path}: {source}")]
    Image { path: String, source: object::Error },
    /// The program does not fit this chip's memory.
    #[error("the program has {size} bytes at {address:#010x}, where the chip has no flash")]
    NoFlash { address: u32, size: usize },
}

/// The use of a feature that is not modelled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotModelled {
    /// Name of the unit; `None` if there is no unit at the address.
    pub unit: Option<&'static str>,
    /// The address.
    pub address: u32,
    /// The written value, if it was a write.
    pub written: Option<u32>,
    /// The reason.
    pub why: AccessError,
}

/// The reason why an access fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AccessError {
    /// There is no unit of the virtual board.
    #[error("the virtual board has no peripheral there")]
    Nobody,
    /// The unit is modelled, but not this register or these bits.
    #[error(transparent)]
    Unit(Unmodelled),
    /// The unit's clock is off, or the unit is held in reset.
    #[error("its clock is off, or it is held in reset")]
    Stopped,
    /// Accesses of this width are not modelled.
    #[error("an access of that width is not modelled")]
    Width,
    /// A converter has sampled a floating channel.
    #[error("it has sampled a channel that nothing drives")]
    Floating,
}

impl fmt::Display for NotModelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.unit.unwrap_or("nothing that is modelled");
        match self.written {
            Some(value) => write!(f, "the program wrote {value:#010x} to ")?,
            None => f.write_str("the program read ")?,
        }
        write!(f, "{:#010x}, in {unit}: {}", self.address, self.why)
    }
}

#[cfg(test)]
mod tests {
    use crate::board::VirtualBoard;
    use crate::chip::NUCLEO_G474RE;
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
            (said(0x4000_1024, None), ["0x40001024, in TIM6", "not modelled"]),
            (said(0x4000_1000, Some(0x81)), ["0x40001000, in TIM6", "bits 0x00000080"]),
            (
                said(0x4000_4418, Some(1)),
                ["wrote 0x00000001 to 0x40004418, in USART2", "not modelled"],
            ),
            (said(0x4000_0024, None), ["0x40000024, in TIM2", "its clock is off"]),
            (said(0x4002_0400, None), ["0x40020400", "no peripheral there"]),
            (said(0xE000_EF00, Some(3)), ["0xe000ef00, in the system control space", "not"]),
        ] {
            assert!(parts.iter().all(|part| sentence.contains(part)), "{sentence}");
        }
    }
}
