//! One tick as it is told to the host, and the queue that carries it.

use heapless::spsc::{Consumer, Producer, Queue};

use super::State;
use crate::dac::DacCode;
use crate::torque::LimitReason;

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Periods since the servo started, wrapping.
    pub tick: u32,
    /// The position's low 32 bits in counts.
    pub count: i32,
    /// The code that was written.
    pub code: DacCode,
    /// Why it is less than the scene asked for.
    pub limit: LimitReason,
    /// What the servo was doing.
    pub state: State,
    /// Timer counts that were left of the period; 0 where the tick was late.
    pub slack: u32,
}

/// Something that takes a frame a tick and never waits.
pub trait FrameSink {
    /// Takes a frame, or drops it and counts that.
    fn push(&mut self, frame: Frame);
    /// Frames dropped since the start, wrapping.
    fn dropped(&self) -> u32;
}

/// The queue of frames from the interrupt to the task that sends them. Holds `LENGTH - 1`.
#[derive(Debug)]
pub struct FrameQueue<const LENGTH: usize>(Queue<Frame, LENGTH>);

impl<const LENGTH: usize> FrameQueue<LENGTH> {
    /// An empty queue.
    pub const fn new() -> Self {
        Self(Queue::new())
    }

    /// The interrupt's end and the task's end.
    pub fn split(&mut self) -> (Frames<'_>, Consumer<'_, Frame>) {
        let (producer, consumer) = self.0.split();
        (Frames { producer, dropped: 0 }, consumer)
    }
}

impl<const LENGTH: usize> Default for FrameQueue<LENGTH> {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's end of a [`FrameQueue`].
pub struct Frames<'a> {
    producer: Producer<'a, Frame>,
    dropped: u32,
}

impl FrameSink for Frames<'_> {
    #[inline(always)]
    fn push(&mut self, frame: Frame) {
        if self.producer.enqueue(frame).is_err() {
            core::hint::cold_path();
            self.dropped = self.dropped.wrapping_add(1);
        }
    }

    fn dropped(&self) -> u32 {
        self.dropped
    }
}
