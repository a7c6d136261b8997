//! DMA1 and its multiplexer (RM0440, 12.6 and 13.6): channels that move halfwords or words between a unit and the
//! memory.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled, only};

const ISR: u32 = 0x00;
const IFCR: u32 = 0x04;
/// Offset of the first channel's registers, and their distance.
const CHANNELS: u32 = 0x08;
const STRIDE: u32 = 0x14;
const CONTROL: u32 = 0x00;
const COUNT: u32 = 0x04;
const PERIPHERAL: u32 = 0x08;
const MEMORY: u32 = 0x0C;

/// CCR: enabled, an interrupt at the end, from the memory, in a circle, the next address of the memory; halfwords or
/// words, the same for the unit and the memory; the priority, which the order of the channels decides here.
const ENABLE: u32 = 1;
const INTERRUPT: u32 = 1 << 1;
const FROM_MEMORY: u32 = 1 << 4;
const CIRCLE: u32 = 1 << 5;
const INCREMENT: u32 = 1 << 7;
const SIZES: u32 = 0b1111 << 8;
const HALFWORDS: u32 = 0b0101 << 8;
const WORDS: u32 = 0b1010 << 8;
const PRIORITY: u32 = 0b11 << 12;
const MODELLED: u32 = ENABLE | INTERRUPT | FROM_MEMORY | CIRCLE | INCREMENT | SIZES | PRIORITY;

/// TCIF of each channel in ISR and IFCR.
const ENDED: [u32; NUMBER] = [1, 5, 9, 13, 17, 21];

const CHANNEL: Table =
    &[(CONTROL, 0, MODELLED), (COUNT, 0, 0xFFFF), (PERIPHERAL, 0, u32::MAX), (MEMORY, 0, u32::MAX)];

/// Core clocks of a move, at least [M].
const MOVE: u64 = 4;

/// Channels, as many as the smallest of the chips has.
const NUMBER: usize = 6;
/// Channels of the multiplexer whose events are inputs of others, and generators of requests.
const EVENTS: usize = 4;

/// CCR of a channel of the multiplexer: the request; events; synchronised, at rising edges of an input; requests of a
/// count, less one.
const REQUEST: u32 = 0x7F;
const MAKES_EVENTS: u32 = 1 << 9;
const SYNCHRONISED: u32 = 1 << 16;
const RISING: u32 = 1 << 17;
const MULTIPLEXER: u32 = REQUEST | MAKES_EVENTS | SYNCHRONISED | RISING | 0x1F << 19 | 0x1F << 24;
/// RGCR of a generator: its input; enabled; at rising edges; requests at an edge, less one.
const GENERATORS: u32 = 0x100;
const GENERATES: u32 = 1 << 16;
const GENERATOR: u32 = 0x1F | GENERATES | RISING | 0x1F << 19;
/// The input that is the event of the first channel.
const FIRST_EVENT: u32 = 16;

/// The number of requests in a register of the multiplexer.
fn requests(control: u32) -> u32 {
    (control >> 19 & 0x1F) + 1
}

/// A move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Move {
    /// The request that it serves.
    pub request: u32,
    /// The unit's register.
    pub peripheral: u32,
    /// The place in the memory.
    pub memory: u32,
    /// Bytes: 2 or 4.
    pub size: usize,
    /// Whether the register is written.
    pub from_memory: bool,
}

#[derive(Clone, Debug)]
struct Channel {
    registers: Registers,
    /// Its register of the multiplexer, requests left of a count, and whether they pass.
    multiplexer: u32,
    counted: u32,
    is_connected: bool,
    /// Moves of a circle, and those that are left.
    length: u32,
    left: u32,
    ended: bool,
}

/// A generator of requests: its register, and requests that were not served yet.
#[derive(Clone, Copy, Debug, Default)]
struct Generator {
    control: u32,
    left: u32,
}

/// The unit with its multiplexer.
#[derive(Clone, Debug)]
pub struct Dma {
    channels: [Channel; NUMBER],
    generators: [Generator; EVENTS],
    /// The end of the last move.
    free: u64,
}

impl Default for Dma {
    /// The unit after reset.
    fn default() -> Self {
        let channel = || Channel {
            registers: Registers::new(CHANNEL),
            multiplexer: 0,
            counted: 0,
            is_connected: false,
            length: 0,
            left: 0,
            ended: false,
        };
        let generators = [Generator::default(); EVENTS];
        Self { channels: std::array::from_fn(|_| channel()), generators, free: 0 }
    }
}

impl Channel {
    fn request(&self) -> u32 {
        self.multiplexer & REQUEST
    }

    fn runs(&self) -> bool {
        let passes = self.multiplexer & SYNCHRONISED == 0 || self.is_connected;
        passes && self.registers.has(CONTROL, ENABLE) && self.left > 0
    }

    /// Its next move.
    fn step(&mut self) -> Move {
        let registers = &self.registers;
        let size = if registers.get(CONTROL) & SIZES == WORDS { 4 } else { 2 };
        let passed = self.length - self.left;
        let moved = if registers.has(CONTROL, INCREMENT) { size * passed } else { 0 };
        let next = Move {
            request: self.request(),
            peripheral: registers.get(PERIPHERAL),
            memory: registers.get(MEMORY) + moved,
            size: size as usize,
            from_memory: registers.has(CONTROL, FROM_MEMORY),
        };
        self.left -= 1;
        if self.left == 0 {
            self.ended = true;
            self.left = if registers.has(CONTROL, CIRCLE) { self.length } else { 0 };
        }
        next
    }

    /// A request is served: at the end of a count the channel disconnects, and whether it makes an event.
    fn count(&mut self) -> bool {
        if self.multiplexer & (SYNCHRONISED | MAKES_EVENTS) == 0 {
            return false;
        }
        if self.counted > 1 {
            self.counted -= 1;
            return false;
        }
        self.counted = requests(self.multiplexer);
        self.is_connected = false;
        self.multiplexer & MAKES_EVENTS != 0
    }
}

impl Dma {
    /// The channel that moves next, where units make these requests.
    fn first(&self, is_requested: impl Fn(u32) -> bool) -> Option<usize> {
        let runs = |it: &Channel| it.runs() && self.is_requested(it.request(), &is_requested);
        self.channels.iter().position(runs)
    }

    fn is_requested(&self, request: u32, of_units: impl Fn(u32) -> bool) -> bool {
        match request as usize {
            generated @ 1..=EVENTS => self.generators[generated - 1].left > 0,
            _ => of_units(request),
        }
    }

    /// When the next move is due.
    pub fn due(&self, is_requested: impl Fn(u32) -> bool) -> Option<u64> {
        self.first(is_requested).map(|_| self.free)
    }

    /// The move of the first channel whose request is made.
    pub fn next(&mut self, now: u64, is_requested: impl Fn(u32) -> bool) -> Option<Move> {
        let at = self.first(&is_requested).filter(|_| self.free <= now)?;
        self.free = now + MOVE;
        let next = self.channels[at].step();
        if let generated @ 1..=EVENTS = next.request as usize {
            self.generators[generated - 1].left -= 1;
        }
        if self.channels[at].count() && at < EVENTS {
            self.event(FIRST_EVENT + at as u32, is_requested);
        }
        Some(next)
    }

    /// An edge at an input of the multiplexer. One without a waiting request synchronises nothing; one before a count
    /// has ended changes nothing (RM0440, DMAMUX: an overrun).
    fn event(&mut self, input: u32, is_requested: impl Fn(u32) -> bool) {
        for at in 0..NUMBER {
            let (control, request) = (self.channels[at].multiplexer, self.channels[at].request());
            let waits = control & SYNCHRONISED != 0
                && control & RISING != 0
                && control >> 24 == input
                && self.is_requested(request, &is_requested);
            self.channels[at].is_connected |= waits;
        }
        for Generator { control, left } in &mut self.generators {
            let listens = *control & GENERATES != 0 && *control & RISING != 0;
            if listens && *control & 0x1F == input && *left == 0 {
                *left = requests(*control);
            }
        }
    }

    /// Whether a channel serves this request.
    pub fn serves(&self, request: u32) -> bool {
        self.channels.iter().any(|it| it.request() == request && it.runs())
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
            return Ok(ended.zip(ENDED).map(|(ended, bit)| ended << bit).sum());
        }
        let (channel, register) = self.channel(offset)?;
        if register == COUNT { Ok(channel.left) } else { channel.registers.read(register) }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        if offset == IFCR {
            for (channel, bit) in self.channels.iter_mut().zip(ENDED) {
                channel.ended &= value >> bit & 1 == 0;
            }
            return Ok(());
        }
        let (channel, register) = self.channel(offset)?;
        let sizes = value & SIZES;
        if register == CONTROL && ![0, HALFWORDS, WORDS].contains(&sizes) {
            return Err(Unmodelled::Bits(value));
        }
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

    /// The register of the multiplexer at an offset.
    fn multiplexer(&mut self, offset: u32) -> Option<&mut u32> {
        match offset.checked_sub(GENERATORS) {
            Some(at) => Some(&mut self.generators.get_mut(at as usize / 4)?.control),
            None => Some(&mut self.channels.get_mut(offset as usize / 4)?.multiplexer),
        }
    }

    /// Reads the multiplexer.
    pub fn read_multiplexer(&mut self, offset: u32) -> Access<u32> {
        self.multiplexer(offset).copied().ok_or(Unmodelled::Register)
    }

    /// Writes the multiplexer.
    pub fn write_multiplexer(&mut self, offset: u32, value: u32) -> Access<()> {
        let [modelled, active] = match offset {
            ..GENERATORS => [MULTIPLEXER, SYNCHRONISED | MAKES_EVENTS],
            _ => [GENERATOR, GENERATES],
        };
        only(value, modelled)?;
        let register = self.multiplexer(offset).ok_or(Unmodelled::Register)?;
        // The number of requests does not change while they are counted.
        if *register & active != 0 && requests(*register) != requests(value) {
            return Err(Unmodelled::Bits(value));
        }
        *register = value;
        if let Some(channel) = self.channels.get_mut(offset as usize / 4) {
            channel.counted = requests(value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEGINS: u32 = 8;
    const WANTED: u32 = 13;

    /// Channel 0 serves a request and makes an event, on which channel 1 may move two words, and a generator has
    /// channel 2 move three.
    fn chained() -> Dma {
        let mut dma = Dma::default();
        let event = FIRST_EVENT;
        for (offset, value) in [
            (0, BEGINS | MAKES_EVENTS),
            (4, WANTED | RISING | 1 << 19 | event << 24),
            (4, WANTED | RISING | SYNCHRONISED | 1 << 19 | event << 24),
            (8, 1),
            (GENERATORS, event | RISING | 2 << 19),
            (GENERATORS, event | RISING | GENERATES | 2 << 19),
        ] {
            dma.write_multiplexer(offset, value).unwrap();
        }
        for channel in 0..3 {
            let at = CHANNELS + channel * STRIDE;
            dma.write(at + COUNT, 5).unwrap();
            dma.write(at + CONTROL, ENABLE | CIRCLE | FROM_MEMORY | HALFWORDS).unwrap();
        }
        dma
    }

    /// The requests that are served from a time on, while the units make these; with the time of the last.
    fn served(dma: &mut Dma, asked: &[u32]) -> Vec<u32> {
        let mut now = dma.free;
        let mut begins = asked.contains(&BEGINS);
        let mut served = Vec::new();
        loop {
            let next = dma.next(now, |request| match request {
                BEGINS => begins,
                _ => asked.contains(&request),
            });
            let Some(Move { request, .. }) = next else { return served };
            begins &= request != BEGINS;
            served.push(request);
            assert_eq!(dma.next(now, |_| true), None, "one at a time");
            now += MOVE;
        }
    }

    #[test]
    fn an_event_lets_a_count_of_requests_pass_and_generates_others() {
        let mut dma = chained();
        assert!(served(&mut dma, &[WANTED]).is_empty());
        for _ in 0..3 {
            let expected = [BEGINS, WANTED, WANTED, 1, 1, 1];
            assert_eq!(served(&mut dma, &[BEGINS, WANTED]), expected);
            assert!(served(&mut dma, &[WANTED]).is_empty());
        }
    }

    /// A request that is made after the event waits for the next one.
    #[test]
    fn an_event_without_a_waiting_request_lets_none_pass() {
        let mut dma = chained();
        assert_eq!(served(&mut dma, &[BEGINS]), [BEGINS, 1, 1, 1]);
        assert!(served(&mut dma, &[WANTED]).is_empty());
    }

    #[test]
    fn a_count_does_not_change_while_it_is_in_use() {
        let mut dma = chained();
        let control = WANTED | RISING | SYNCHRONISED | FIRST_EVENT << 24;
        assert!(dma.write_multiplexer(4, control | 1 << 19).is_ok());
        assert!(dma.write_multiplexer(4, control | 2 << 19).is_err());
        assert!(dma.write_multiplexer(4, 1 << 8).is_err(), "an interrupt at an overrun");
    }
}
