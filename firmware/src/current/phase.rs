//! The phase of a brushless motor and the speed of the handle from the counts of an encoder.
//!
//! Angles are parts of an electrical turn in 32 bits, which wrap as turns do.

use crate::encoder::{CounterWidth, RawCount};

/// Weight of the last instant's counts in the mean: a time constant of 32 instants, which makes a count of a
/// coarse encoder a small step of the phase.
const NEWEST: f32 = 1.0 / 32.0;

/// The position of the handle in its turn, in whole counts, so that no error accumulates over any number of
/// turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// From zero to the counts of a turn less one.
    pub count: i32,
    pub counts: i32,
    /// Electrical turns in a count, times 2^64: over a turn its rounding adds up to less than 2^-40 of a
    /// turn.
    scale: u64,
    /// Electrical turns in a turn.
    pub pole_pairs: u16,
}

impl Turn {
    /// The position at the count 0 of an encoder with `counts` counts per turn.
    pub(super) const fn new(counts: u32, pole_pairs: u16) -> Self {
        let whole = (pole_pairs as u128) << 64;
        // The quotient is below 2^59: no electrical turn has fewer than 64 counts.
        let scale = ((whole + counts as u128 / 2) / counts as u128) as u64;
        Self { count: 0, counts: counts.cast_signed(), scale, pole_pairs }
    }

    /// Moves by a step.
    #[inline(always)]
    pub(super) const fn move_by(&mut self, step: i32) {
        let mut count = self.count.wrapping_add(step);
        if count < 0 {
            count = count.wrapping_add(self.counts);
        } else if count >= self.counts {
            count -= self.counts;
        }
        self.count = if 0 <= count && count < self.counts { count } else { self.far(step) };
    }

    /// The position after a step of more than a turn, which no handle makes.
    #[cold]
    #[inline(never)]
    const fn far(&self, step: i32) -> i32 {
        (self.count as i64 + step as i64).rem_euclid(self.counts as i64) as i32
    }

    /// Electrical angle since the count 0.
    #[inline(always)]
    pub(super) const fn angle(&self) -> u32 {
        self.angle_of(self.count.cast_unsigned())
    }

    /// Electrical angle of a number of counts.
    #[inline(always)]
    pub(super) const fn angle_of(&self, counts: u32) -> u32 {
        ((counts as u64).wrapping_mul(self.scale) >> 32) as u32
    }

    /// The number of counts nearest to an electrical angle, less than an electrical turn.
    pub(super) const fn electrical_counts(&self, angle: u32) -> u32 {
        let turns = angle as u128 * self.counts.cast_unsigned() as u128;
        let one = (self.pole_pairs as u128) << 32;
        // The quotient is at most the counts of a turn.
        let nearest = ((turns + one / 2) / one) as u32;
        let is_whole_turn = nearest as u128 * self.pole_pairs as u128 >= self.counts as u128;
        if is_whole_turn { 0 } else { nearest }
    }

    /// Counts in an electrical turn.
    pub(super) const fn counts_per_electrical_turn(&self) -> f32 {
        self.counts as f32 / self.pole_pairs as f32
    }
}

/// The relation between the phase of a motor and the counts of its encoder: the result of an
/// [`Alignment`](super::Alignment).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseAlignment {
    /// Electrical angle at the count 0, in parts of a turn of 2^32.
    pub offset: u32,
    /// Whether the angle falls while the count rises: the encoder, or two of the motor's wires, are reversed.
    pub is_reversed: bool,
}

impl PhaseAlignment {
    /// The angle of the motor's magnets, from the encoder's angle since the count 0.
    #[inline(always)]
    pub(super) const fn angle(&self, since_zero: u32) -> u32 {
        let angle = if self.is_reversed { since_zero.wrapping_neg() } else { since_zero };
        self.offset.wrapping_add(angle)
    }

    /// The sign of a current or a speed in the direction of rising counts.
    #[inline(always)]
    pub(super) const fn sign(&self) -> f32 {
        if self.is_reversed { -1.0 } else { 1.0 }
    }
}

/// The mean of the counts in an instant, for the angle by which the phase turns until its voltage acts.
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
