//! The record of a fault in memory that survives a reset.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

use super::Fault;

/// Marks the words as a record of this layout.
const MAGIC: u32 = 0x4841_5031;

/// Without a table, which would take a kilobyte: a record is rarely written.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// A fault with its tick and position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultRecord {
    /// The fault.
    pub fault: Fault,
    /// The tick of the fault; 0 if unknown.
    pub tick: u32,
    /// The position's low 32 bits in counts; 0 if unknown.
    pub count: i32,
}

impl FaultRecord {
    /// Length of a record in words.
    pub const WORDS: usize = 7;
    /// Words that are not a record.
    pub const NOTHING: [u32; Self::WORDS] = [0; Self::WORDS];

    /// The record as words.
    pub fn encode(&self) -> [u32; Self::WORDS] {
        let (code, [a, b]) = self.fault.encode();
        let words = [MAGIC, code, a, b, self.tick, self.count.cast_unsigned(), 0];
        sealed(words)
    }

    /// The record in these words; `None` if [`FaultRecord::encode`] cannot have written them.
    pub fn decode(words: &[u32; Self::WORDS]) -> Option<Self> {
        let [magic, code, a, b, tick, count, _] = *words;
        if magic != MAGIC || sealed(*words) != *words {
            return None;
        }
        let fault = Fault::decode(code, [a, b])?;
        Some(Self { fault, tick, count: count.cast_signed() })
    }
}

/// The words with their checksum in the last word.
fn sealed(words: [u32; FaultRecord::WORDS]) -> [u32; FaultRecord::WORDS] {
    let [magic, code, a, b, tick, count, _] = words;
    let mut digest = CRC.digest();
    for word in [magic, code, a, b, tick, count] {
        digest.update(&word.to_le_bytes());
    }
    [magic, code, a, b, tick, count, digest.finalize()]
}
