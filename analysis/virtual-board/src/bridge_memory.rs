//! The state of a bridge's program in memory, which no pin shows: the servo's last code, and whether the
//! motor is being aligned.

use crate::image::Image;
use crate::processor::Processor;

/// Ends of the symbols' mangled names: the compiler may number what it splits.
const CODE: [&str; 2] = ["6bridge7WAITING", "6bridge7WAITING.0"];
const STATE: [&str; 2] = ["6bridge5STATE", "6bridge5STATE.0"];

/// States from this one on are of an alignment: requested, and running.
const FIRST_OF_ALIGNMENT: u8 = 3;

/// The addresses of this state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BridgeMemory {
    code: u32,
    state: u32,
}

impl BridgeMemory {
    /// The addresses in this program; `None` if it does not drive a bridge.
    pub fn of(image: &Image) -> Option<Self> {
        let place = |names: [&str; 2]| {
            let found = names.iter().find_map(|name| image.symbol_ending(name));
            found.map(|(place, _)| place)
        };
        Some(Self { code: place(CODE)?, state: place(STATE)? })
    }

    /// The servo's last code.
    pub fn code(&self, core: &Processor) -> Option<u16> {
        let bytes = core.memory(self.code, 2)?;
        Some(u16::from_le_bytes(bytes.try_into().ok()?))
    }

    /// Whether an alignment runs, or is about to.
    pub fn is_aligning(&self, core: &Processor) -> Option<bool> {
        let state = core.memory(self.state, 1)?;
        Some(state[0] >= FIRST_OF_ALIGNMENT)
    }
}
