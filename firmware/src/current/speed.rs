//! The speed of the handle from the encoder's counts in each instant, for the angle by which a brushless
//! motor's phase turns until its voltage acts.

use crate::encoder::{CounterWidth, RawCount};

/// Weight of the last instant's counts in the mean: a time constant of 32 instants, which makes a count of a
/// coarse encoder a small step of the phase.
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

    /// Restarts the mean from zero.
    pub(super) const fn restart(&mut self) {
        self.mean = 0.0;
    }

    /// Counts since the last reading, less than half the counter's range. The first reading counts from the
    /// nearest zero.
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

    /// Takes the counts of an instant; returns their mean.
    #[inline(always)]
    pub(super) const fn update(&mut self, counts: f32) -> f32 {
        self.mean += NEWEST * (counts - self.mean);
        self.mean
    }
}
