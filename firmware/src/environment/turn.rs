//! Angles within a turn, for what repeats for ever: nothing is lost after any number of turns.

use core::f64::consts::TAU;
use core::hint::cold_path;

use crate::build_error::BuildError;
use crate::number::Number;

/// A turn within which counts are counted, or none.
#[derive(Clone, Copy, Debug)]
pub struct Turn<N> {
    /// Counts of it; more than an encoder has where there is none.
    counts: i32,
    /// The count from which it counts, a whole number of turns, in its low 32 bits.
    origin: i32,
    angle: N,
    is_endless: bool,
}

impl<N: Number> Turn<N> {
    /// The most counts of a turn: so that two of them are below half of the counter.
    const MOST_COUNTS: i32 = 1 << 28;

    /// No turn: all positions are what they are.
    pub(crate) const fn none() -> Self {
        Self { counts: Self::MOST_COUNTS, origin: 0, angle: N::ZERO, is_endless: false }
    }

    /// One of an encoder that is not known yet.
    ///
    /// # Errors
    /// Where the number format has no room for a turn.
    pub(crate) fn endless() -> Result<Self, BuildError> {
        Ok(Self { angle: BuildError::number("a turn", TAU)?, is_endless: true, ..Self::none() })
    }

    /// Takes the encoder's counts a turn.
    ///
    /// # Errors
    /// Where a turn has no whole number of them, or too many.
    pub(crate) fn set_counts(&mut self, counts_per_turn: f64) -> Result<(), BuildError> {
        if !self.is_endless {
            return Ok(());
        }
        let counts = counts_per_turn as i32;
        let largest = f64::from(Self::MOST_COUNTS);
        let is_counted = (1.0..=largest).contains(&counts_per_turn);
        if f64::from(counts) != counts_per_turn || !is_counted {
            return Err(BuildError::Turn { counts: counts_per_turn, largest });
        }
        self.counts = counts;
        Ok(())
    }

    /// Starts at a position that may be any number of turns away from zero.
    pub(crate) fn start_at(&mut self, count: i64) {
        if self.is_endless {
            let whole_turns = count - count % i64::from(self.counts);
            // Its low bits are all that is compared.
            self.origin = whole_turns as i32;
        }
    }

    /// The position within a turn, from its low 32 bits, and the whole turns, if any, by which it left the
    /// one before: positions are from a turn below zero to one above, so that none is left for a step
    /// back and forth. `None`: far away, and no turn to be within.
    #[inline(always)]
    pub(crate) fn within(&mut self, count: i32) -> Option<(i32, i32)> {
        let within = count.wrapping_sub(self.origin);
        if within.wrapping_add(self.counts).cast_unsigned() <= 2 * self.counts.cast_unsigned() {
            return Some((within, 0));
        }
        cold_path();
        if !self.is_endless {
            return None;
        }
        let turns = within / self.counts;
        self.origin = self.origin.wrapping_add(turns.wrapping_mul(self.counts));
        Some((within % self.counts, turns))
    }

    /// The angle in rad by which positions move when these turns are left.
    pub(crate) fn left(&self, turns: i32) -> N {
        /// What moves by more in a tick is a fault.
        const MOST: u32 = 16;
        let mut angle = N::ZERO;
        for _ in 0..turns.unsigned_abs().min(MOST) {
            angle = if turns > 0 { angle.minus(self.angle) } else { angle.plus(self.angle) };
        }
        angle
    }

    /// An angle in rad within a turn; the angle itself where there is none.
    pub(crate) fn wrapped(&self, angle: f64) -> f64 {
        if self.is_endless { angle % TAU } else { angle }
    }
}
