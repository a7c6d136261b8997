//! Frames to the host: the order in which they leave, the frame that is being sent, and the ticks of the servo's
//! queue that are packed into messages, as many as the wire can carry.

use core::num::NonZeroU32;

use crate::servo_loop::{Frame, FrameReader};
use crate::wire::frame::{encode, largest_frame};
use crate::wire::message::{LONGEST_TO_HOST, ToHostWith};
use crate::wire::telemetry::Batch;
use serde::Serialize;

/// The largest number of other messages that are sent before the answer to an accepted request, once the servo
/// has done it, and before a set is certified: one of each other kind, and the other two parts of a greeting.
pub const MESSAGES_AHEAD: usize = Turn::COUNT - 1 + 2;

/// The kinds of frames to the host. They take turns: after a frame, each other kind has its turn before the
/// next frame of the same kind. The parts of a greeting follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    Disarming,
    Arming,
    Alignment,
    Greeting,
    Refusal,
    Status,
    Parameters,
    Description,
    Set,
    Telemetry,
}

impl Turn {
    /// The number of kinds.
    pub(super) const COUNT: usize = 10;
    /// The first turn after a reset.
    pub(super) const FIRST: Self = Self::Disarming;

    /// The kind whose turn follows.
    pub(super) const fn next(self) -> Self {
        match self {
            Self::Disarming => Self::Arming,
            Self::Arming => Self::Alignment,
            Self::Alignment => Self::Greeting,
            Self::Greeting => Self::Refusal,
            Self::Refusal => Self::Status,
            Self::Status => Self::Parameters,
            Self::Parameters => Self::Description,
            Self::Description => Self::Set,
            Self::Set => Self::Telemetry,
            Self::Telemetry => Self::Disarming,
        }
    }
}

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
    pub(super) fn put<R: Serialize>(&mut self, message: &ToHostWith<&str, R>) {
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

/// The longest time in s that a tick waits for a full batch: a picture at 30 Hz.
const PATIENCE: f64 = 0.03;

/// The selection of ticks that are sent to the host.
pub(super) struct Stream {
    every: Option<NonZeroU32>,
    batch: Batch,
    /// The first tick in the batch.
    first: u32,
    /// The last tick that went into a batch.
    last: u32,
    /// The largest number of ticks that the first tick of a batch waits.
    patience: u32,
    due: bool,
    thinned: u32,
}

impl Stream {
    /// No ticks until a request. `period` in s.
    pub(super) fn new(period: f64) -> Self {
        // The cast saturates.
        let patience = (PATIENCE / period) as u32;
        let batch = Batch::new();
        Self { every: None, batch, first: 0, last: 0, patience, due: false, thinned: 0 }
    }

    /// Selects one tick of every so many from now on, or none.
    pub(super) fn set(&mut self, every: Option<NonZeroU32>) {
        self.every = every;
        self.batch = Batch::new();
        self.due = false;
    }

    /// Takes ticks from the servo's queue until a message is full. While the message waits for the wire, the
    /// next ticks wait in the queue, up to half of its length; the rest is omitted and counted, so that a
    /// slow wire never makes the queue overflow.
    pub(super) fn take<const LENGTH: usize>(&mut self, frames: &mut FrameReader<'_, LENGTH>) {
        for _ in 0..LENGTH {
            if self.due && frames.waiting() <= LENGTH / 2 {
                return;
            }
            let Some(frame) = frames.take() else { return };
            if let Some(every) = self.every {
                self.add(frame, every);
            }
        }
    }

    fn add(&mut self, frame: Frame, every: NonZeroU32) {
        let is_wanted = frame.tick.wrapping_sub(self.last) >= every.get();
        if is_wanted {
            self.last = frame.tick;
            if self.batch.is_empty() {
                self.first = frame.tick;
            }
            if self.batch.push(frame).is_err() {
                self.thinned = self.thinned.wrapping_add(1);
            }
        }
        let waited = frame.tick.wrapping_sub(self.first);
        self.due = self.batch.is_full() || (!self.batch.is_empty() && waited >= self.patience);
    }

    pub(super) fn batch(&mut self) -> Option<Batch> {
        if !core::mem::take(&mut self.due) {
            return None;
        }
        Some(core::mem::take(&mut self.batch))
    }

    /// Ticks that were omitted because the wire is slower.
    pub(super) const fn thinned(&self) -> u32 {
        self.thinned
    }
}
