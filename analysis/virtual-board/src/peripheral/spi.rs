//! An SPI as a master whose words the DMA moves (RM0440, 39.9), and the chip at its wires.

use std::collections::VecDeque;

use super::registers::{Registers, Table};
use super::{Access, Unmodelled};
use crate::magnetic_encoder::MagneticEncoder;

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SR: u32 = 0x08;
/// The data register.
pub const DATA: u32 = 0x0C;

/// CR1: enabled; master; the divider of its clock; the phase and the level at rest of that clock.
const ENABLE: u32 = 1 << 6;
const MASTER: u32 = 1 << 2;
const DIVIDER: u32 = 0b111 << 3;
const MODE: u32 = 0b11;
/// CR2: bits of a word less one, NSS is an output, and the requests for both directions.
const SIZE: u32 = 0xF << 8;
const SELECTS: u32 = 1 << 2;
const SENDS: u32 = 1 << 1;
const RECEIVES: u32 = 1;

/// SR: a received word; room for a word to send; a word on the wires or before it.
const RECEIVED: u32 = 1;
const ROOM: u32 = 1 << 1;
const BUSY: u32 = 1 << 7;

const REGISTERS: Table =
    &[(CR1, 0, ENABLE | MASTER | DIVIDER | MODE), (CR2, 0x0700, SIZE | SELECTS | SENDS | RECEIVES)];

/// Words of more than a byte in the buffer of either direction.
const BUFFER: usize = 2;

/// The unit.
#[derive(Clone, Debug)]
pub struct Spi {
    registers: Registers,
    sent: VecDeque<u16>,
    received: VecDeque<u16>,
    /// When the last bit of the word on the wires is sampled.
    done: Option<u64>,
    /// Until when it is busy with that bit.
    busy: u64,
    /// Words that were lost because the unit was disabled while it was busy.
    pub cut: u32,
}

impl Default for Spi {
    /// The unit after reset.
    fn default() -> Self {
        let (sent, received) = (VecDeque::new(), VecDeque::new());
        Self { registers: Registers::new(REGISTERS), sent, received, done: None, busy: 0, cut: 0 }
    }
}

impl Spi {
    /// When the last bit of the word on the wires is sampled.
    pub fn due(&self) -> Option<u64> {
        self.done
    }

    fn word_bits(&self) -> u32 {
        (self.registers.get(CR2) >> 8 & 0xF) + 1
    }

    /// Core clocks of half a bit.
    fn half_bit(&self, bus_divider: u64) -> u64 {
        bus_divider << (self.registers.get(CR1) >> 3 & 0b111)
    }

    /// Moves words at the wires that have ended by now.
    pub fn advance(&mut self, now: u64, bus_divider: u64, chip: Option<&mut MagneticEncoder>) {
        let mut chip = chip;
        while let Some(done) = self.done.filter(|done| *done <= now) {
            let (bits, word) = (self.word_bits(), self.sent.pop_front().unwrap_or(0));
            let shifted = |chip: &mut MagneticEncoder| {
                (0..bits).rev().fold(0, |received, bit| {
                    received << 1 | u16::from(chip.clock(word >> bit & 1 != 0))
                })
            };
            // The input is pulled up.
            let received = chip.as_deref_mut().map_or(u16::MAX >> (16 - bits), shifted);
            if self.received.len() < BUFFER {
                self.received.push_back(received);
            }
            self.done = None;
            self.busy = done + self.half_bit(bus_divider);
            self.begin(self.busy, bus_divider);
        }
        self.begin(now, bus_divider);
    }

    /// Begins a word if there is one.
    fn begin(&mut self, now: u64, bus_divider: u64) {
        let runs = self.registers.has_all(CR1, ENABLE | MASTER);
        if runs && self.done.is_none() && !self.sent.is_empty() {
            // The second edge of the last bit (CPHA).
            let half_bits = u64::from(2 * self.word_bits() - 1);
            self.done = Some(now.max(self.busy) + half_bits * self.half_bit(bus_divider));
        }
    }

    /// Whether it requests that a received word be taken.
    pub fn requests_taking(&self) -> bool {
        self.registers.has(CR2, RECEIVES) && !self.received.is_empty()
    }

    /// Whether it requests a word to send.
    pub fn requests_word(&self) -> bool {
        self.registers.has(CR2, SENDS) && self.has_room()
    }

    fn has_room(&self) -> bool {
        // The word on the wires has left the buffer.
        self.sent.len() - usize::from(self.done.is_some()) < BUFFER
    }

    fn is_busy(&self, now: u64) -> bool {
        self.registers.has(CR1, ENABLE) && (!self.sent.is_empty() || now < self.busy)
    }

    /// Reads.
    pub fn read(&mut self, offset: u32, now: u64) -> Access<u32> {
        match offset {
            SR => {
                let flag = |is: bool, bit| if is { bit } else { 0 };
                let received = flag(!self.received.is_empty(), RECEIVED);
                Ok(received | flag(self.has_room(), ROOM) | flag(self.is_busy(now), BUSY))
            }
            DATA => Ok(self.received.pop_front().ok_or(Unmodelled::Register)?.into()),
            _ => self.registers.read(offset),
        }
    }

    /// Writes, at a time and with this divider of the bus's clock; the chip sees when it is selected and released.
    pub fn write(
        &mut self,
        offset: u32,
        value: u32,
        (now, bus_divider): (u64, u64),
        chip: Option<&mut MagneticEncoder>,
    ) -> Access<()> {
        if offset == DATA {
            self.sent.push_back(value as u16);
            self.begin(now, bus_divider);
            return Ok(());
        }
        let was = self.registers.has(CR1, ENABLE);
        // What becomes of a word that is cut off is not in the manual (RM0440, SPI: how to disable it).
        if offset == CR1 && self.is_busy(now) && value & ENABLE == 0 {
            self.cut += 1;
            if self.done.take().is_some() {
                self.sent.pop_front();
            }
        }
        self.registers.write(offset, value)?;
        let is = self.registers.has(CR1, ENABLE);
        if let Some(chip) = chip
            && was != is
            && self.registers.has(CR2, SELECTS)
        {
            // CPOL and CPHA: the chip's mode, or it sees other edges.
            if is {
                chip.select(now, self.registers.get(CR1) & MODE);
            } else {
                chip.release(now);
            }
        }
        self.begin(now, bus_divider);
        Ok(())
    }
}
