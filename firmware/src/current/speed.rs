//! The speed of the handle, from the encoder's counts in each instant: how far a brushless motor's phase turns
//! until its voltage acts.

use crate::encoder::{CounterWidth, RawCount};

/// Part of the last instant's counts in the mean: a time constant of 32 instants, behind which a count of
/// a coarse encoder is a small step of the phase.
const NEWEST: f32 = 1.0 / 32.0;

/// Mean of the counts in an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speed {
    last: u32,
    width: CounterWidth,
    mean: f32,
}

impl Speed {
    pub(super) const fn new(width: CounterWidth) -> Self {
        Self { last: 0, width, mean: 0.0 }
    }

    /// Goes on with the mean from zero.
    pub(super) const fn restart(&mut self) {
        self.mean = 0.0;
    }

    /// Counts since the last reading, which are fewer than half the counter's range. The first one is since the
    /// zero that is nearest.
    #[inline(always)]
    pub(super) const fn step(&mut self, position: RawCount) -> i32 {
        let step = self.since_last(position);
        self.last = position.bits();
        step
    }

    /// Counts from the last reading to a reading near it.
    #[inline(always)]
    pub(super) const fn since_last(&self, position: RawCount) -> i32 {
        let shift = self.width as u32;
        (position.bits().wrapping_sub(self.last) << shift).cast_signed() >> shift
    }

    /// Takes a step; gives the mean of the counts in an instant.
    #[inline(always)]
    pub(super) const fn update(&mut self, step: i32) -> f32 {
        self.mean += NEWEST * (step as f32 - self.mean);
        self.mean
    }
}
