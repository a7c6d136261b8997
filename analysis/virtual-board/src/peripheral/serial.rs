//! A serial port: a byte takes as long as on a line, and a byte that is not read in time is lost.
//!
//! Two variants of it: the G4's with a queue of eight bytes each way (RM0440, 37.8), the F405's with
//! one (RM0090, 30.6).

use std::collections::VecDeque;

use super::{Access, Unmodelled, only};

/// Variant of the USART, by its registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UsartVariant {
    /// The G4's.
    G4,
    /// The F405's.
    F405,
}

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
/// CR1 of the G4: the port is on; its queues are.
const ON_G4: u32 = 1;
const QUEUES: u32 = 1 << 29;
/// CR1 of the F405: the port is on.
const ON_F405: u32 = 1 << 13;
/// CR3: errors of the line, of which only the overrun can occur.
const ERRORS: u32 = 1;
/// Bits of a byte on the line, with its start and its stop.
const FRAME: u64 = 10;

/// The port.
#[derive(Clone, Debug)]
pub struct Serial {
    variant: UsartVariant,
    control: [u32; 3],
    rate: u32,
    prescaler: u32,
    /// Overrun and idle.
    latched: u32,
    /// G4: a transmission has ended since that was last cleared; F405: the same.
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
    pub fn new(variant: UsartVariant) -> Self {
        Self {
            variant,
            control: [0; 3],
            rate: 0,
            prescaler: 0,
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
        let on = self.control[0] & self.on() != 0 && self.rate > 0;
        if !on {
            (self.arrives, self.leaves) = (None, None);
            return;
        }
        let byte = FRAME * u64::from(self.rate) * divider;
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
        let enabled = self.control[0] & INTERRUPTS;
        // An overrun asks by the interrupt of what was received, and by that of errors.
        let overrun = self.control[0] & RECEIVED != 0 || self.control[2] & ERRORS != 0;
        status & enabled != 0 || (status & OVERRUN != 0 && overrun)
    }

    /// Reads.
    pub fn read(&mut self, offset: u32) -> Access<u32> {
        use UsartVariant::{F405, G4};
        Ok(match (self.variant, offset) {
            (G4, 0x00 | 0x04 | 0x08) => self.control[offset as usize / 4],
            (G4, 0x0C) => self.rate,
            (G4, 0x1C) => self.status() | ENABLED,
            (G4, 0x24) => self.receive(),
            (G4, 0x2C) => self.prescaler,
            (F405, 0x00) => self.status(),
            (F405, 0x04) => {
                // The status was read before, and this clears its flags.
                self.latched = 0;
                self.receive()
            }
            (F405, 0x08) => self.rate,
            (F405, 0x0C | 0x10 | 0x14) => self.control[(offset as usize - 0x0C) / 4],
            _ => return Err(Unmodelled::Register),
        })
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        use UsartVariant::{F405, G4};
        match (self.variant, offset) {
            (G4, 0x00) => {
                only(value, ON_G4 | BOTH_WAYS | INTERRUPTS | QUEUES)?;
                self.control[0] = value;
            }
            (F405, 0x0C) => {
                only(value, ON_F405 | BOTH_WAYS | INTERRUPTS)?;
                self.control[0] = value;
            }
            // One stop bit, nothing inverted.
            (G4, 0x04) | (F405, 0x10) => only(value, 0)?,
            (G4, 0x08) | (F405, 0x14) => {
                only(value, ERRORS)?;
                self.control[2] = value;
            }
            (G4, 0x0C) | (F405, 0x08) => {
                only(value, 0xFFFF)?;
                self.rate = value;
            }
            // Cleared by writing ones.
            (G4, 0x20) => {
                self.latched &= !value;
                self.sent &= value & SENT == 0;
            }
            (G4, 0x28) | (F405, 0x04) => {
                self.sent = false;
                self.outgoing.push_back(value as u8);
            }
            (G4, 0x2C) => only(value, 0)?,
            // Cleared by writing zeros.
            (F405, 0x00) => self.sent &= value & SENT != 0,
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }

    fn receive(&mut self) -> u32 {
        self.incoming.pop_front().unwrap_or(0).into()
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
        if self.control[0] & QUEUES != 0 && self.variant == UsartVariant::G4 { 8 } else { 1 }
    }

    fn on(&self) -> u32 {
        match self.variant {
            UsartVariant::G4 => ON_G4,
            UsartVariant::F405 => ON_F405,
        }
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
    fn open(variant: UsartVariant) -> Serial {
        let mut port = Serial::new(variant);
        let setup: &[(u32, u32)] = match variant {
            UsartVariant::G4 => &[(0x0C, RATE), (0x00, ON_G4 | BOTH_WAYS | RECEIVED | QUEUES)],
            UsartVariant::F405 => &[(0x08, RATE), (0x0C, ON_F405 | BOTH_WAYS | RECEIVED)],
        };
        for &(register, value) in setup {
            port.write(register, value).unwrap();
        }
        port
    }

    fn received(port: &mut Serial) -> u32 {
        port.read(if port.variant == UsartVariant::G4 { 0x24 } else { 0x04 }).unwrap()
    }

    #[test]
    fn a_byte_takes_its_time_on_the_line() {
        for variant in [UsartVariant::G4, UsartVariant::F405] {
            let mut port = open(variant);
            port.send(b"ab");
            port.advance(100, DIVIDER);
            assert_eq!(port.due(), Some(100 + BYTE));
            port.advance(100 + BYTE - 1, DIVIDER);
            assert!(!port.line(), "{variant:?}");
            port.advance(100 + BYTE, DIVIDER);
            assert!(port.line(), "{variant:?}");
            assert_eq!(received(&mut port), b'a'.into());
            assert!(!port.line(), "{variant:?}");
            port.advance(100 + 2 * BYTE, DIVIDER);
            assert_eq!(received(&mut port), b'b'.into());
        }
    }

    #[test]
    fn what_is_not_read_in_time_is_lost_and_told() {
        for (variant, room) in [(UsartVariant::G4, 8), (UsartVariant::F405, 1)] {
            let mut port = open(variant);
            let bytes: Vec<u8> = (1..=room + 3).collect();
            port.send(&bytes);
            port.advance(0, DIVIDER);
            let end = BYTE * u64::from(room + 3);
            port.advance(end, DIVIDER);
            assert_eq!(port.lost(), 3, "{variant:?}");
            // What was there stays, and what came in vain is gone.
            let status = port.read(if variant == UsartVariant::G4 { 0x1C } else { 0x00 }).unwrap();
            assert_eq!(status & OVERRUN, OVERRUN, "{variant:?}");
            for byte in 1..=room {
                assert_eq!(received(&mut port), byte.into(), "{variant:?}");
            }
            // By its flag on one chip, and by having read status and data on the other.
            if variant == UsartVariant::G4 {
                assert!(port.line());
                port.write(0x20, OVERRUN).unwrap();
            }
            assert!(!port.line(), "{variant:?}");
            port.send(b"z");
            port.advance(end, DIVIDER);
            port.advance(end + 2 * BYTE, DIVIDER);
            assert_eq!(received(&mut port), b'z'.into(), "{variant:?}");
        }
    }

    #[test]
    fn silence_behind_a_byte_is_told_once() {
        for variant in [UsartVariant::G4, UsartVariant::F405] {
            let mut port = open(variant);
            let status = if variant == UsartVariant::G4 { 0x1C } else { 0x00 };
            port.send(b"a");
            port.advance(0, DIVIDER);
            port.advance(BYTE, DIVIDER);
            assert_eq!(port.read(status).unwrap() & IDLE, 0, "{variant:?}");
            port.advance(2 * BYTE, DIVIDER);
            assert_eq!(port.read(status).unwrap() & IDLE, IDLE, "{variant:?}");
            assert_eq!(port.due(), None, "{variant:?}");
        }
    }

    #[test]
    fn what_is_sent_leaves_byte_by_byte() {
        for variant in [UsartVariant::G4, UsartVariant::F405] {
            let mut port = open(variant);
            let (data, status) =
                if variant == UsartVariant::G4 { (0x28, 0x1C) } else { (0x04, 0x00) };
            port.write(data, b'x'.into()).unwrap();
            port.advance(0, DIVIDER);
            assert_eq!(port.read(status).unwrap() & SENT, 0, "{variant:?}");
            port.advance(BYTE - 1, DIVIDER);
            assert_eq!(port.take_sent(), b"", "{variant:?}");
            port.advance(BYTE, DIVIDER);
            assert_eq!(port.take_sent(), b"x", "{variant:?}");
            assert_eq!(port.read(status).unwrap() & SENT, SENT, "{variant:?}");
        }
    }
}
