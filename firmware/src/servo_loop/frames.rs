//! One tick as sent to the host, and the queue that carries it from the interrupt to the task that sends it.

use core::hint::cold_path;
use core::sync::atomic::{AtomicU32, Ordering};

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
    /// The reason if the torque is limited.
    pub limit: LimitReason,
    /// The servo's state.
    pub state: State,
    /// Timer counts left of the period, or with a fixed phase until the output of the code; 0 if the tick was
    /// late.
    pub slack: u32,
}

/// A receiver of one frame per tick that never waits.
pub trait FrameSink {
    /// Takes a frame, or drops it and counts that.
    fn push(&mut self, frame: Frame);
    /// Frames dropped since the start, wrapping.
    fn dropped(&self) -> u32;
}

type Words = [u32; 4];

impl Frame {
    #[inline(always)]
    fn to_words(self) -> Words {
        let small = u32::from(self.code.get())
            | (self.limit as u32) << LIMIT
            | (self.state as u32) << STATE;
        [self.tick, self.count.cast_unsigned(), small, self.slack]
    }

    fn from_words([tick, count, small, slack]: Words) -> Self {
        let of = |shift: u32| (small >> shift & 0xff) as usize;
        Self {
            tick,
            count: count.cast_signed(),
            code: DacCode::from_low_bits((small & 0xffff) as u16),
            limit: LimitReason::ALL.get(of(LIMIT)).copied().unwrap_or_default(),
            state: State::ALL.get(of(STATE)).copied().unwrap_or_default(),
            slack,
        }
    }
}

const LIMIT: u32 = 16;
const STATE: u32 = 24;

/// A lock-free queue of `LENGTH` frames, a power of two, with one writer and one reader.
///
/// Made of atomic words, not taken from a crate. With a constant length a push costs half as much as with a
/// division by a length at run time, and cannot panic. No slot is shared by reference, so no `unsafe` is
/// needed.
#[derive(Debug)]
pub struct FrameQueue<const LENGTH: usize> {
    slots: [[AtomicU32; 4]; LENGTH],
    /// Frames taken since the start, wrapping.
    taken: AtomicU32,
    /// Frames pushed since the start, wrapping.
    pushed: AtomicU32,
}

impl<const LENGTH: usize> FrameQueue<LENGTH> {
    /// An empty queue.
    pub const fn new() -> Self {
        const { assert!(LENGTH.is_power_of_two(), "a queue's length is a power of two") };
        Self {
            slots: [const { [const { AtomicU32::new(0) }; 4] }; LENGTH],
            taken: AtomicU32::new(0),
            pushed: AtomicU32::new(0),
        }
    }

    /// The interrupt's end and the task's end.
    pub fn split(&mut self) -> (Frames<'_, LENGTH>, FrameReader<'_, LENGTH>) {
        let queue = &*self;
        (Frames { queue, dropped: 0 }, FrameReader { queue })
    }

    /// The slot of a frame by its number; never out of range.
    #[inline(always)]
    fn slot(&self, number: u32) -> &[AtomicU32; 4] {
        &self.slots[number as usize % LENGTH]
    }
}

impl<const LENGTH: usize> Default for FrameQueue<LENGTH> {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's end of a [`FrameQueue`].
#[derive(Debug)]
pub struct Frames<'a, const LENGTH: usize> {
    queue: &'a FrameQueue<LENGTH>,
    dropped: u32,
}

impl<const LENGTH: usize> FrameSink for Frames<'_, LENGTH> {
    #[inline(always)]
    fn push(&mut self, frame: Frame) {
        let queue = self.queue;
        let number = queue.pushed.load(Ordering::Relaxed);
        let waiting = number.wrapping_sub(queue.taken.load(Ordering::Acquire));
        if waiting >= LENGTH as u32 {
            cold_path();
            self.dropped = self.dropped.wrapping_add(1);
            return;
        }
        for (place, word) in queue.slot(number).iter().zip(frame.to_words()) {
            place.store(word, Ordering::Relaxed);
        }
        queue.pushed.store(number.wrapping_add(1), Ordering::Release);
    }

    fn dropped(&self) -> u32 {
        self.dropped
    }
}

/// The task's end of a [`FrameQueue`].
#[derive(Debug)]
pub struct FrameReader<'a, const LENGTH: usize> {
    queue: &'a FrameQueue<LENGTH>,
}

impl<const LENGTH: usize> FrameReader<'_, LENGTH> {
    /// The number of waiting frames.
    pub fn waiting(&self) -> usize {
        let taken = self.queue.taken.load(Ordering::Relaxed);
        self.queue.pushed.load(Ordering::Acquire).wrapping_sub(taken) as usize
    }

    /// Takes the oldest frame.
    pub fn take(&mut self) -> Option<Frame> {
        let queue = self.queue;
        let number = queue.taken.load(Ordering::Relaxed);
        if number == queue.pushed.load(Ordering::Acquire) {
            return None;
        }
        let mut words: Words = [0; 4];
        for (word, place) in words.iter_mut().zip(queue.slot(number)) {
            *word = place.load(Ordering::Relaxed);
        }
        queue.taken.store(number.wrapping_add(1), Ordering::Release);
        Some(Frame::from_words(words))
    }
}
