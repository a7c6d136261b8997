//! Inert registers: they store writes, which have no effect here.

use super::{Access, Unmodelled, only};

/// A peripheral of inert registers.
#[derive(Clone, Debug)]
pub struct InertRegisters {
    /// Each register's place, its value out of reset, and its bits that may be written.
    layout: &'static [(u32, u32, u32)],
    /// What they hold, a word each from place 0 on; 0 where there is no register.
    values: Vec<u32>,
}

impl InertRegisters {
    /// Registers of this layout, out of reset: place, value, bits that may be written.
    pub fn new(layout: &'static [(u32, u32, u32)]) -> Self {
        let last = layout.iter().map(|&(offset, ..)| offset as usize / 4).max();
        let mut plain = Self { layout, values: vec![0; last.map_or(0, |last| last + 1)] };
        for &(offset, value, _) in layout {
            plain.set(offset, value);
        }
        plain
    }

    /// The value of a register; 0 if there is no such register.
    pub fn get(&self, offset: u32) -> u32 {
        self.values.get(offset as usize / 4).copied().unwrap_or(0)
    }

    /// Sets a register of the layout, also a read-only one.
    pub fn set(&mut self, offset: u32, value: u32) {
        self.values[offset as usize / 4] = value;
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        self.find(offset)?;
        Ok(self.get(offset))
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        self.check(offset, value, 0)?;
        self.set(offset, value);
        Ok(())
    }

    /// Whether a value may be written there, whatever it has of the chip's `own` bits.
    pub(super) fn check(&self, offset: u32, value: u32, own: u32) -> Access<()> {
        let (_, reset, modelled) = self.find(offset)?;
        // Features that are not modelled keep their reset state.
        only((value ^ reset) & !own, modelled)
    }

    /// A register as the layout has it.
    fn find(&self, offset: u32) -> Access<(u32, u32, u32)> {
        let here = self.layout.iter().find(|(place, ..)| *place == offset);
        here.copied().ok_or(Unmodelled::Register)
    }
}
