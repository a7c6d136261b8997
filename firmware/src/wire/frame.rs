//! A message as bytes on the wire: postcard, followed by a CRC-32, both in COBS, with a zero on either side.
//!
//! COBS leaves no zero inside a frame, so a zero always ends one: a decoder resynchronises at the next zero.
//! The zero in front separates the frame from noise on an idle wire. CRC-32 and not CRC-16: a corrupted
//! parameter set must not be accepted, and one random frame in 65,536 passes 16 bits.

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc};
use postcard::ser_flavors::crc::CrcModifier;
use postcard::ser_flavors::{Cobs, Flavor, Slice};
use serde::Serialize;

/// Ends a frame.
pub const DELIMITER: u8 = 0;
/// Bytes of the checksum.
pub const CHECKSUM: usize = size_of::<u32>();
/// The checksum of Ethernet and zip, which is available everywhere.
pub(super) static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The largest size of a frame with a message of `message` bytes: checksum, COBS, and the zero on either
/// side.
pub const fn largest_frame(message: usize) -> usize {
    let checked = message + CHECKSUM;
    checked + checked / 254 + 3
}

/// Writes a message as a frame, and returns the frame.
///
/// # Errors
/// If the frame does not fit `buffer`; see [`largest_frame`].
pub fn encode<'b, M: Serialize>(message: &M, buffer: &'b mut [u8]) -> Result<&'b [u8], TooLong> {
    let too_long = TooLong { size: buffer.len() };
    let (first, rest) = buffer.split_first_mut().ok_or(too_long)?;
    *first = DELIMITER;
    let cobs = Cobs::try_new(Slice::new(rest)).map_err(|_| too_long)?;
    let checked = OutOfLine(CrcModifier::new(cobs, CRC.digest()));
    // COBS ends with the delimiter.
    let used = postcard::serialize_with_flavor(message, checked).map_err(|_| too_long)?.len();
    buffer.get(..1 + used).ok_or(too_long)
}

/// Calls a function for each byte instead of inlining it wherever a message writes a byte: on a board this
/// saves kilobytes of flash.
struct OutOfLine<F>(F);

impl<F: Flavor> Flavor for OutOfLine<F> {
    type Output = F::Output;

    #[inline(never)]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.0.try_push(byte)
    }

    #[inline(never)]
    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        bytes.iter().try_for_each(|&byte| self.try_push(byte))
    }

    fn finalize(self) -> postcard::Result<Self::Output> {
        self.0.finalize()
    }
}

/// A frame that does not fit its buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong {
    /// Bytes of the buffer.
    pub size: usize,
}

impl fmt::Display for TooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the message does not fit a frame of {} bytes", self.size)
    }
}

impl core::error::Error for TooLong {}
