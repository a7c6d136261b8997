//! Decodes messages byte by byte, safely for any bytes.

use cobs::{DecodeResult, DecoderState};
use serde::Deserialize;

use super::frame::{CHECKSUM, CRC};

/// Finds frames in a stream of bytes. Other bytes are dropped and counted; the next zero starts
/// anew.
///
/// `SIZE` is the longest message with its checksum, in bytes. A longer message is dropped while it arrives
/// and takes no space.
///
/// ```
/// use haptic_servo::wire::{Decoder, encode};
///
/// let mut buffer = [0; 32];
/// let frame = encode(&(7_u8, true), &mut buffer)?;
/// let mut decoder = Decoder::<16>::new();
/// let noise = [0x55, 0x00, 0x12];
/// let messages = noise.iter().chain(frame).filter_map(|&byte| {
///     decoder.push::<(u8, bool)>(byte)
/// });
/// assert_eq!(messages.collect::<Vec<_>>(), [(7, true)]);
/// assert_eq!(decoder.discarded().total(), 2);
/// # Ok::<(), haptic_servo::wire::TooLong>(())
/// ```
#[derive(Debug)]
pub struct Decoder<const SIZE: usize> {
    cobs: DecoderState,
    buffer: [u8; SIZE],
    /// Bytes of the frame so far, including those that did not fit.
    length: usize,
    discarded: Discarded,
}

/// Frames that a decoder dropped, by the reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Discarded {
    /// Incomplete, or too short for a checksum: noise, or lost bytes.
    pub broken: u32,
    /// Longer than any message.
    pub too_long: u32,
    /// The checksum is wrong.
    pub checksum: u32,
    /// The checksum is correct, but the content is not a message of this protocol.
    pub unknown: u32,
}

impl Discarded {
    /// The sum of the counts. Each count stops at its largest value and does not wrap.
    pub const fn total(&self) -> u32 {
        self.broken
            .saturating_add(self.too_long)
            .saturating_add(self.checksum)
            .saturating_add(self.unknown)
    }
}

/// Why one frame is dropped.
enum Fault {
    Broken,
    TooLong,
    Checksum,
    Unknown,
}

impl<const SIZE: usize> Decoder<SIZE> {
    /// A decoder that waits for a frame.
    pub const fn new() -> Self {
        Self {
            cobs: DecoderState::Idle,
            buffer: [0; SIZE],
            length: 0,
            discarded: Discarded { broken: 0, too_long: 0, checksum: 0, unknown: 0 },
        }
    }

    /// Takes a byte, and returns the message that the byte completes, if any.
    pub fn push<'a, M: Deserialize<'a>>(&'a mut self, byte: u8) -> Option<M> {
        let length = match self.cobs.feed(byte) {
            Ok(DecodeResult::NoData) => return None,
            Ok(DecodeResult::DataContinue(decoded)) => {
                if let Some(free) = self.buffer.get_mut(self.length) {
                    *free = decoded;
                }
                self.length = self.length.saturating_add(1);
                return None;
            }
            Ok(DecodeResult::DataComplete) => Some(core::mem::take(&mut self.length)),
            Err(_) => {
                self.length = 0;
                None
            }
        };
        match message(&self.buffer, length) {
            Ok(message) => Some(message),
            Err(fault) => {
                self.discarded.count(fault);
                None
            }
        }
    }

    /// Frames dropped so far.
    pub const fn discarded(&self) -> Discarded {
        self.discarded
    }
}

impl<const SIZE: usize> Default for Decoder<SIZE> {
    fn default() -> Self {
        Self::new()
    }
}

impl Discarded {
    fn count(&mut self, fault: Fault) {
        let counter = match fault {
            Fault::Broken => &mut self.broken,
            Fault::TooLong => &mut self.too_long,
            Fault::Checksum => &mut self.checksum,
            Fault::Unknown => &mut self.unknown,
        };
        *counter = counter.saturating_add(1);
    }
}

/// The message in a frame of that length; `None` stands for an incomplete frame.
fn message<'a, M: Deserialize<'a>>(buffer: &'a [u8], length: Option<usize>) -> Result<M, Fault> {
    let length = length.ok_or(Fault::Broken)?;
    let frame = buffer.get(..length).ok_or(Fault::TooLong)?;
    let (message, checksum) = frame.split_last_chunk::<CHECKSUM>().ok_or(Fault::Broken)?;
    if CRC.checksum(message) != u32::from_le_bytes(*checksum) {
        return Err(Fault::Checksum);
    }
    match postcard::take_from_bytes(message) {
        Ok((message, [])) => Ok(message),
        // Extra bytes are an error, like missing bytes.
        Ok(_) | Err(_) => Err(Fault::Unknown),
    }
}
