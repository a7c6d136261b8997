//! Packs ticks of the servo's queue into messages, as many as the wire can carry.

use core::num::NonZeroU32;

use crate::servo_loop::{Frame, FrameReader};
use crate::wire::telemetry::Batch;

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

    /// The batch that is due.
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
