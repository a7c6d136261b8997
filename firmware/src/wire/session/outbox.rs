//! The frame that is being sent to the host.

use crate::wire::frame::{encode, largest_frame};
use crate::wire::message::{LONGEST_TO_HOST, ToHost};

/// One frame, and the number of bytes already sent.
pub(super) struct Outbox {
    buffer: [u8; largest_frame(LONGEST_TO_HOST)],
    gone: usize,
    end: usize,
}

impl Outbox {
    pub(super) const fn new() -> Self {
        Self { buffer: [0; largest_frame(LONGEST_TO_HOST)], gone: 0, end: 0 }
    }

    /// Whether everything is sent.
    pub(super) const fn is_empty(&self) -> bool {
        self.gone >= self.end
    }

    /// Takes a message; the rest of the previous message is discarded.
    pub(super) fn put(&mut self, message: &ToHost<&str>) {
        self.gone = 0;
        // The buffer has room for the longest message; a longer one would not be sent.
        self.end = encode(message, &mut self.buffer).map_or(0, <[u8]>::len);
    }

    /// The unsent bytes.
    pub(super) fn rest(&self) -> &[u8] {
        self.buffer.get(self.gone..self.end).unwrap_or_default()
    }

    /// Marks this number of bytes as sent.
    pub(super) const fn sent(&mut self, bytes: usize) {
        self.gone = self.gone.saturating_add(bytes);
    }
}
