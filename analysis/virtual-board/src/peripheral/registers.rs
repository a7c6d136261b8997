//! A unit's registers as a table: they store writes, and refuse bits that are not modelled. Units add what
//! the bits do.

use super::{Access, Unmodelled, only};

/// Offset of each register, its value after reset, and its bits that may be written.
pub type Table = &'static [(u32, u32, u32)];

/// The registers of a unit.
#[derive(Clone, Debug)]
pub struct Registers {
    table: Table,
    /// The values, a word each from offset 0 on; 0 where there is no register.
    values: Vec<u32>,
}

impl Registers {
    /// Registers after reset.
    pub fn new(table: Table) -> Self {
        let last = table.iter().map(|&(offset, ..)| offset as usize / 4).max();
        let mut registers = Self { table, values: vec![0; last.map_or(0, |last| last + 1)] };
        for &(offset, value, _) in table {
            registers.set(offset, value);
        }
        registers
    }

    /// The value of a register; 0 if there is no such register.
    pub fn get(&self, offset: u32) -> u32 {
        self.values.get(offset as usize / 4).copied().unwrap_or(0)
    }

    /// Whether a register has one of these bits set.
    pub fn has(&self, offset: u32, bits: u32) -> bool {
        self.get(offset) & bits != 0
    }

    /// Whether a register has all of these bits set.
    pub fn has_all(&self, offset: u32, bits: u32) -> bool {
        self.get(offset) & bits == bits
    }

    /// Sets a register of the table, also a read-only one.
    pub fn set(&mut self, offset: u32, value: u32) {
        self.values[offset as usize / 4] = value;
    }

    /// Sets bits of a register of the table, and clears others before.
    pub fn change(&mut self, offset: u32, clear: u32, set: u32) {
        self.set(offset, self.get(offset) & !clear | set);
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

    /// A register as the table has it.
    fn find(&self, offset: u32) -> Access<(u32, u32, u32)> {
        let here = self.table.iter().find(|(place, ..)| *place == offset);
        here.copied().ok_or(Unmodelled::Register)
    }
}
