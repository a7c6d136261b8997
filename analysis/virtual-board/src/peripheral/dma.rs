//! DMA1 and its multiplexer (RM0440, 12.6 and 13.6): channels that move halfwords between a unit and the memory.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled};

const ISR: u32 = 0x00;
const IFCR: u32 = 0x04;
/// Offset of the first channel's registers, and their distance.
const CHANNELS: u32 = 0x08;
const STRIDE: u32 = 0x14;
const CONTROL: u32 = 0x00;
const COUNT: u32 = 0x04;
const PERIPHERAL: u32 = 0x08;
const MEMORY: u32 = 0x0C;

/// CCR: enabled, an interrupt at the end, from the memory, in a circle, the next address of the memory; halfwords;
/// the priority, which the order of the channels decides here.
const ENABLE: u32 = 1;
const INTERRUPT: u32 = 1 << 1;
const FROM_MEMORY: u32 = 1 << 4;
const CIRCLE: u32 = 1 << 5;
const INCREMENT: u32 = 1 << 7;
const HALFWORDS: u32 = 0b0101 << 8;
const PRIORITY: u32 = 0b11 << 12;
const MODELLED: u32 = ENABLE | INTERRUPT | FROM_MEMORY | CIRCLE | INCREMENT | HALFWORDS | PRIORITY;

const CHANNEL: Table =
    &[(CONTROL, 0, MODELLED), (COUNT, 0, 0xFFFF), (PERIPHERAL, 0, u32::MAX), (MEMORY, 0, u32::MAX)];

/// Modelled channels.
const NUMBER: usize = 3;

/// A move of a halfword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Move {
    /// The request that it serves.
    pub request: u32,
    /// The unit's register.
    pub peripheral: u32,
    /// The place in the memory.
    pub memory: u32,
    /// Whether the register is written.
    pub from_memory: bool,
}

#[derive(Clone, Debug)]
struct Channel {
    registers: Registers,
    request: u32,
    /// Moves of a circle, and those that are left.
    length: u32,
    left: u32,
    ended: bool,
}

/// The unit with its multiplexer.
#[derive(Clone, Debug)]
pub struct Dma {
    channels: [Channel; NUMBER],
}

impl Default for Dma {
    /// The unit after reset.
    fn default() -> Self {
        let channel = || Channel {
            registers: Registers::new(CHANNEL),
            request: 0,
            length: 0,
            left: 0,
            ended: false,
        };
        Self { channels: std::array::from_fn(|_| channel()) }
    }
}

impl Dma {
    /// The first channel whose request is made, with its move.
    pub fn next(&mut self, is_requested: impl Fn(u32) -> bool) -> Option<Move> {
        let runs = |it: &&mut Channel| {
            it.registers.has(CONTROL, ENABLE) && it.left > 0 && is_requested(it.request)
        };
        let channel = self.channels.iter_mut().find(runs)?;
        let registers = &channel.registers;
        let step =
            if registers.has(CONTROL, INCREMENT) { 2 * (channel.length - channel.left) } else { 0 };
        let next = Move {
            request: channel.request,
            peripheral: registers.get(PERIPHERAL),
            memory: registers.get(MEMORY) + step,
            from_memory: registers.has(CONTROL, FROM_MEMORY),
        };
        channel.left -= 1;
        if channel.left == 0 {
            channel.ended = true;
            channel.left = if registers.has(CONTROL, CIRCLE) { channel.length } else { 0 };
        }
        Some(next)
    }

    /// Whether a channel serves this request.
    pub fn serves(&self, request: u32) -> bool {
        self.channels
            .iter()
            .any(|it| it.request == request && it.registers.has(CONTROL, ENABLE) && it.left > 0)
    }

    /// The level of the first channel's interrupt line.
    pub fn line(&self) -> bool {
        self.channels[0].ended && self.channels[0].registers.has(CONTROL, INTERRUPT)
    }

    /// The channel of an offset, and the offset of its register.
    fn channel(&mut self, offset: u32) -> Access<(&mut Channel, u32)> {
        let at = offset.checked_sub(CHANNELS).ok_or(Unmodelled::Register)?;
        let channel = self.channels.get_mut((at / STRIDE) as usize);
        Ok((channel.ok_or(Unmodelled::Register)?, at % STRIDE))
    }

    /// Reads.
    pub fn read(&mut self, offset: u32) -> Access<u32> {
        if offset == ISR {
            let ended = self.channels.iter().map(|channel| u32::from(channel.ended));
            return Ok(ended.zip([1, 5, 9]).map(|(ended, bit)| ended << bit).sum());
        }
        let (channel, register) = self.channel(offset)?;
        if register == COUNT { Ok(channel.left) } else { channel.registers.read(register) }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        if offset == IFCR {
            for (channel, bit) in self.channels.iter_mut().zip([1, 5, 9]) {
                channel.ended &= value >> bit & 1 == 0;
            }
            return Ok(());
        }
        let (channel, register) = self.channel(offset)?;
        // An enabled channel does not change.
        if register != CONTROL && channel.registers.has(CONTROL, ENABLE) {
            return Err(Unmodelled::Register);
        }
        channel.registers.write(register, value)?;
        if register == COUNT {
            (channel.length, channel.left) = (value, value);
        }
        Ok(())
    }

    /// Reads the multiplexer.
    pub fn read_request(&self, offset: u32) -> Access<u32> {
        let channel = self.channels.get(offset as usize / 4);
        Ok(channel.ok_or(Unmodelled::Register)?.request)
    }

    /// Writes the multiplexer.
    pub fn set_request(&mut self, offset: u32, request: u32) -> Access<()> {
        let channel = self.channels.get_mut(offset as usize / 4);
        channel.ok_or(Unmodelled::Register)?.request = request;
        Ok(())
    }
}
