//! Angles within a turn, for what repeats for ever: nothing is lost after any number of turns.

use core::f64::consts::TAU;
use core::hint::cold_path;

use crate::build_error::BuildError;
use crate::number::Number;

/// A turn within which counts are counted.
#[derive(Clone, Copy, Debug)]
pub struct Turn<N> {
    counts: i32,
    /// The count from which it counts, a whole number of turns, in its low 32 bits.
    origin: i32,
    angle: N,
}

impl<N: Number> Turn<N> {
    /// The most counts of a turn: so that two of them are below half of the counter.
    const MOST_COUNTS: f64 = (1_u32 << 28) as f64;

    /// Of an encoder that is not known yet.
    ///
    /// # Errors
    /// Where the number format has no room for a turn.
    pub(crate) fn new() -> Result<Self, BuildError> {
        Ok(Self { counts: 1, origin: 0, angle: BuildError::number("a turn", TAU)? })
    }

    /// Takes the encoder's counts a turn.
    ///
    /// # Errors
    /// Where that is no whole number, or too large.
    pub(crate) fn set_counts(&mut self, counts_per_turn: f64) -> Result<(), BuildError> {
        let counts = counts_per_turn as i32;
        let is_counted = (1.0..=Self::MOST_COUNTS).contains(&counts_per_turn);
        if f64::from(counts) != counts_per_turn || !is_counted {
            return Err(BuildError::Turn { counts: counts_per_turn, largest: Self::MOST_COUNTS });
        }
        self.counts = counts;
        Ok(())
    }

    /// Starts at a position that may be any number of turns away from zero.
    pub(crate) fn start_at(&mut self, count: i64) {
        let whole_turns = count - count % i64::from(self.counts);
        // Its low bits are all that is compared.
        self.origin = whole_turns as i32;
    }

    /// The position within a turn, from its low 32 bits, and the whole turns, if any, by which it left the
    /// one before: positions are from a turn below zero to one above, so that none is left for a step
    /// back and forth.
    #[inline(always)]
    pub(crate) fn within(&mut self, count: i32) -> (i32, i32) {
        let within = count.wrapping_sub(self.origin);
        if within.wrapping_add(self.counts).cast_unsigned() <= 2 * self.counts.cast_unsigned() {
            return (within, 0);
        }
        cold_path();
        let turns = within / self.counts;
        self.origin = self.origin.wrapping_add(turns.wrapping_mul(self.counts));
        (within % self.counts, turns)
    }

    /// The angle in rad by which positions move when these turns are left.
    pub(crate) fn left(&self, turns: i32) -> N {
        let mut angle = N::ZERO;
        for _ in 0..turns.unsigned_abs() {
            angle = if turns > 0 { angle.minus(self.angle) } else { angle.plus(self.angle) };
        }
        angle
    }

    /// An angle in rad within a turn.
    pub(crate) fn wrapped(angle: f64) -> f64 {
        angle % TAU
    }
}
