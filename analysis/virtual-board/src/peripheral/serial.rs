//! A serial port: a byte takes as long as on a line, and a byte that is not read in time is lost.
//!
//! Two variants of it: the G4's with a queue of eight bytes each way (RM0440, 37.8), the F405's with
//! one (RM0090, 30.6).

use std::collections::VecDeque;

use super::Access;
use super::registers::{Registers, Table};

/// Flags, at the same places in both status registers.
const OVERRUN: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const RECEIVED: u32 = 1 << 5;
const SENT: u32 = 1 << 6;
const ROOM: u32 = 1 << 7;
/// G4's: transmitter and receiver are enabled.
const ENABLED: u32 = 0b11 << 21;
/// CR1: the interrupts of these flags, at the flags' own places.
const INTERRUPTS: u32 = IDLE | RECEIVED | SENT | ROOM;
/// CR1: receiver and transmitter.
const BOTH_WAYS: u32 = 0b11 << 2;
/// CR1 of the G4: the port's queues are on.
const QUEUES: u32 = 1 << 29;
/// CR3: errors of the line, of which only the overrun can occur.
const ERRORS: u32 = 1;
/// Bits of a byte on the line, with its start and its stop.
const FRAME: u64 = 10;

/// The registers of a family's USART.
#[derive(Debug)]
pub struct Variant {
    table: Table,
    /// Offset of CR1, and its bit that switches the port on.
    control: u32,
    on: u32,
    /// Offset of CR3.
    errors: u32,
    /// Offset of BRR.
    rate: u32,
    /// Offset of the status, and its bits that are always set.
    status: u32,
    always: u32,
    /// Offset of the received byte, and whether its read clears the status, which was read before.
    received: u32,
    read_clears: bool,
    /// Offset of the byte to send.
    to_send: u32,
    /// Offset of the register that clears flags, and whether by ones.
    clear: u32,
    by_ones: bool,
}

const G4_ON: u32 = 1;
const F405_ON: u32 = 1 << 13;

/// The G4's.
pub static G4: Variant = Variant {
    table: &[
        (0x00, 0, G4_ON | BOTH_WAYS | INTERRUPTS | QUEUES),
        // One stop bit, nothing inverted.
        (0x04, 0, 0),
        (0x08, 0, ERRORS),
        (0x0C, 0, 0xFFFF),
        (0x2C, 0, 0),
    ],
    control: 0x00,
    on: G4_ON,
    errors: 0x08,
    rate: 0x0C,
    status: 0x1C,
    always: ENABLED,
    received: 0x24,
    read_clears: false,
    to_send: 0x28,
    clear: 0x20,
    by_ones: true,
};

/// The F405's.
pub static F405: Variant = Variant {
    table: &[
        (0x08, 0, 0xFFFF),
        (0x0C, 0, F405_ON | BOTH_WAYS | INTERRUPTS),
        // One stop bit, nothing inverted.
        (0x10, 0, 0),
        (0x14, 0, ERRORS),
    ],
    control: 0x0C,
    on: F405_ON,
    errors: 0x14,
    rate: 0x08,
    status: 0x00,
    always: 0,
    received: 0x04,
    read_clears: true,
    to_send: 0x04,
    clear: 0x00,
    by_ones: false,
};

/// The port.
#[derive(Clone, Debug)]
pub struct Serial {
    variant: &'static Variant,
    registers: Registers,
    /// Overrun and idle.
    latched: u32,
    /// A transmission has ended since that was last cleared.
    sent: bool,
    incoming: VecDeque<u8>,
    outgoing: VecDeque<u8>,
    /// The arrival time of the byte on the line, and the end of the byte being sent.
    arrives: Option<u64>,
    leaves: Option<u64>,
    /// The line was busy and has not been idle since.
    was_busy: bool,
    /// The bytes on their way to the program, and the bytes it has sent.
    line_in: VecDeque<u8>,
    line_out: Vec<u8>,
    /// Bytes that were lost because they were not read in time.
    lost: u64,
}

impl Serial {
    /// Out of reset.
    pub fn new(variant: &'static Variant) -> Self {
        Self {
            variant,
            registers: Registers::new(variant.table),
            latched: 0,
            sent: true,
            incoming: VecDeque::new(),
            outgoing: VecDeque::new(),
            arrives: None,
            leaves: None,
            was_busy: false,
            line_in: VecDeque::new(),
            line_out: Vec::new(),
            lost: 0,
        }
    }

    /// Puts bytes on the line to the program.
    pub fn send(&mut self, bytes: &[u8]) {
        self.line_in.extend(bytes);
    }

    /// What the program has sent since the last time.
    pub fn take_sent(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.line_out)
    }

    /// Bytes that the program lost.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// When something happens on the line next.
    pub fn due(&self) -> Option<u64> {
        [self.arrives, self.leaves].into_iter().flatten().min()
    }

    /// Runs due events, and begins the next transfers; `divider` is the core's clock by the port's.
    pub fn advance(&mut self, now: u64, divider: u64) {
        let rate = u64::from(self.registers.get(self.variant.rate));
        let on = self.control() & self.variant.on != 0 && rate > 0;
        if !on {
            (self.arrives, self.leaves) = (None, None);
            return;
        }
        let byte = FRAME * rate * divider;
        while let Some(at) = self.arrives.filter(|&at| at <= now) {
            self.arrive();
            self.arrives = (self.was_busy || !self.line_in.is_empty()).then_some(at + byte);
        }
        if self.arrives.is_none() && !self.line_in.is_empty() {
            self.arrives = Some(now + byte);
        }
        while let Some(at) = self.leaves.filter(|&at| at <= now) {
            self.line_out.extend(self.outgoing.pop_front());
            self.leaves = (!self.outgoing.is_empty()).then_some(at + byte);
            self.sent |= self.outgoing.is_empty();
        }
        if self.leaves.is_none() && !self.outgoing.is_empty() {
            self.leaves = Some(now + byte);
        }
    }

    /// The line's next byte, or the silence of a byte's length behind the last one.
    fn arrive(&mut self) {
        match self.line_in.pop_front() {
            Some(byte) if self.incoming.len() < self.depth() => {
                self.incoming.push_back(byte);
                self.was_busy = true;
            }
            Some(_) => {
                self.latched |= OVERRUN;
                self.lost += 1;
                self.was_busy = true;
            }
            None => {
                self.latched |= IDLE;
                self.was_busy = false;
            }
        }
    }

    /// The level of its interrupt line.
    pub fn line(&self) -> bool {
        let status = self.status();
        let enabled = self.control() & INTERRUPTS;
        // An overrun asks by the interrupt of what was received, and by that of errors.
        let overrun = enabled & RECEIVED != 0 || self.registers.has(self.variant.errors, ERRORS);
        status & enabled != 0 || (status & OVERRUN != 0 && overrun)
    }

    fn control(&self) -> u32 {
        self.registers.get(self.variant.control)
    }

    /// Reads.
    pub fn read(&mut self, offset: u32) -> Access<u32> {
        let Variant { status, always, received, read_clears, .. } = *self.variant;
        if offset == status {
            return Ok(self.status() | always);
        }
        if offset != received {
            return self.registers.read(offset);
        }
        if read_clears {
            self.latched = 0;
        }
        Ok(self.incoming.pop_front().unwrap_or(0).into())
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let Variant { to_send, clear, by_ones, .. } = *self.variant;
        if offset == to_send {
            self.sent = false;
            self.outgoing.push_back(value as u8);
        } else if offset == clear {
            // By zeros only what was sent is cleared.
            self.latched &= if by_ones { !value } else { u32::MAX };
            self.sent &= (value & SENT == 0) == by_ones;
        } else {
            self.registers.write(offset, value)?;
        }
        Ok(())
    }

    fn status(&self) -> u32 {
        let flag = |set: bool, bit| if set { bit } else { 0 };
        self.latched
            | flag(!self.incoming.is_empty(), RECEIVED)
            | flag(self.sent, SENT)
            | flag(self.outgoing.len() <= self.depth(), ROOM)
    }

    /// Bytes that each of its queues holds.
    fn depth(&self) -> usize {
        if self.control() & QUEUES != 0 { 8 } else { 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The port's clocks of a bit, core clocks of one of them, and core clocks of a byte.
    const RATE: u32 = 91;
    const DIVIDER: u64 = 4;
    const BYTE: u64 = 10 * 91 * 4;

    /// Receives and sends, with the interrupt of what was received.
    fn open(variant: &'static Variant) -> Serial {
        let mut port = Serial::new(variant);
        let queues = if variant.by_ones { QUEUES } else { 0 };
        port.write(variant.rate, RATE).unwrap();
        port.write(variant.control, variant.on | BOTH_WAYS | RECEIVED | queues).unwrap();
        port
    }

    fn received(port: &mut Serial) -> u32 {
        port.read(port.variant.received).unwrap()
    }

    fn status(port: &mut Serial) -> u32 {
        port.read(port.variant.status).unwrap()
    }

    #[test]
    fn a_byte_takes_its_time_on_the_line() {
        for variant in [&G4, &F405] {
            let mut port = open(variant);
            port.send(b"ab");
            port.advance(100, DIVIDER);
            assert_eq!(port.due(), Some(100 + BYTE));
            port.advance(100 + BYTE - 1, DIVIDER);
            assert!(!port.line(), "{}", variant.on);
            port.advance(100 + BYTE, DIVIDER);
            assert!(port.line(), "{}", variant.on);
            assert_eq!(received(&mut port), u32::from(b'a'));
            assert!(!port.line(), "{}", variant.on);
            port.advance(100 + 2 * BYTE, DIVIDER);
            assert_eq!(received(&mut port), u32::from(b'b'));
        }
    }

    #[test]
    fn what_is_not_read_in_time_is_lost_and_told() {
        for (variant, room) in [(&G4, 8), (&F405, 1)] {
            let mut port = open(variant);
            let bytes: Vec<u8> = (1..=room + 3).collect();
            port.send(&bytes);
            port.advance(0, DIVIDER);
            let end = BYTE * u64::from(room + 3);
            port.advance(end, DIVIDER);
            assert_eq!(port.lost(), 3, "{}", variant.on);
            // What was there stays, and what came in vain is gone.
            assert_eq!(status(&mut port) & OVERRUN, OVERRUN, "{}", variant.on);
            for byte in 1..=room {
                assert_eq!(received(&mut port), u32::from(byte), "{}", variant.on);
            }
            // By its flag on one chip, and by having read status and data on the other.
            if variant.by_ones {
                assert!(port.line());
                port.write(variant.clear, OVERRUN).unwrap();
            }
            assert!(!port.line(), "{}", variant.on);
            port.send(b"z");
            port.advance(end, DIVIDER);
            port.advance(end + 2 * BYTE, DIVIDER);
            assert_eq!(received(&mut port), u32::from(b'z'), "{}", variant.on);
        }
    }
}
