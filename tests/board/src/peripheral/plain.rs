//! Registers that only keep what is written: what they switch has no effect here.

use std::collections::BTreeMap;

use super::{Access, Unmodelled, only};

/// A peripheral of such registers.
#[derive(Clone, Debug)]
pub struct Plain {
    /// Each register's place, its value out of reset, and its bits that may be written.
    layout: &'static [(u32, u32, u32)],
    values: BTreeMap<u32, u32>,
}

impl Plain {
    /// Registers of this layout, out of reset: place, value, bits that may be written.
    pub fn new(layout: &'static [(u32, u32, u32)]) -> Self {
        let values = layout.iter().map(|&(offset, value, _)| (offset, value)).collect();
        Self { layout, values }
    }

    /// What a register holds; 0 where there is none.
    pub(super) fn get(&self, offset: u32) -> u32 {
        self.values.get(&offset).copied().unwrap_or(0)
    }

    /// Has a register hold this, whoever may write it.
    pub(super) fn set(&mut self, offset: u32, value: u32) {
        self.values.insert(offset, value);
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        self.values.get(&offset).copied().ok_or(Unmodelled::Register)
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        self.check(offset, value, 0)?;
        self.set(offset, value);
        Ok(())
    }

    /// Whether a value may be written there, whatever it has of the chip's `own` bits.
    pub(super) fn check(&self, offset: u32, value: u32, own: u32) -> Access<()> {
        let (_, reset, modelled) =
            *self.layout.iter().find(|(place, ..)| *place == offset).ok_or(Unmodelled::Register)?;
        // What is not modelled may be left as it was, which is as it came out of reset.
        only((value ^ reset) & !own, modelled)
    }
}
