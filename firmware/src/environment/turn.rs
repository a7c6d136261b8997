//! Angles within a turn, for laws that repeat without end, so that no error accumulates over any number of
//! turns.

use core::f64::consts::TAU;
use core::hint::cold_path;

use crate::build_error::BuildError;
use crate::number::Number;

/// The range of counts: within a turn, from a turn, or unlimited.
#[derive(Clone, Copy, Debug)]
pub struct Turn<N> {
    /// Counts of a turn; without a turn, more than any encoder has.
    counts: i32,
    /// The low 32 bits of its origin, which is a whole number of turns.
    origin: i32,
    angle: N,
    extent: Extent,
}

/// The range of angles.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Extent {
    /// That of the device.
    Device,
    /// A turn, after which they wrap.
    Turn,
    /// That of the device, from the turn in which it starts nearest to this range in rad.
    Range([f64; 2]),
    /// The same in counts.
    Counted {
        /// Counts of a turn.
        turn: i32,
        /// The lower end of the range.
        from: i32,
        /// The upper end of the range.
        to: i32,
    },
}

impl<N: Number> Turn<N> {
    /// The largest number of counts in a turn, so that two turns are below half of the counter.
    const MOST_COUNTS: i32 = 1 << 28;

    /// No turn: positions are not wrapped.
    pub(crate) const fn none() -> Self {
        Self { counts: Self::MOST_COUNTS, origin: 0, angle: N::ZERO, extent: Extent::Device }
    }

    /// A turn whose count restarts with each start; the position is then the nearest to a range in rad.
    pub(crate) fn nearest_to(range: [f64; 2]) -> Self {
        Self { extent: Extent::Range(range), ..Self::none() }
    }

    /// A turn of an encoder that is not known yet.
    ///
    /// # Errors
    /// If the number format cannot represent a turn.
    pub(crate) fn endless() -> Result<Self, BuildError> {
        Ok(Self { angle: BuildError::number("a turn", TAU)?, extent: Extent::Turn, ..Self::none() })
    }

    /// Sets the encoder's counts per turn.
    ///
    /// # Errors
    /// If a turn does not have a whole number of counts, or has too many.
    pub(crate) fn set_counts(&mut self, counts_per_turn: f64) -> Result<(), BuildError> {
        if self.extent == Extent::Device {
            return Ok(());
        }
        let counts = counts_per_turn as i32;
        let largest = f64::from(Self::MOST_COUNTS);
        let is_counted = (1.0..=largest).contains(&counts_per_turn);
        if f64::from(counts) != counts_per_turn || !is_counted {
            return Err(BuildError::Turn { counts: counts_per_turn, largest });
        }
        if let Extent::Range(range) = self.extent {
            // The cast saturates.
            let [from, to] = range.map(|angle| (angle / TAU * counts_per_turn) as i32);
            self.extent = Extent::Counted { turn: counts, from, to };
        } else {
            self.counts = counts;
        }
        Ok(())
    }

    /// Starts at a position that may be any number of turns away from zero.
    pub(crate) fn start_at(&mut self, count: i64) {
        let origin = match self.extent {
            Extent::Turn => whole_turns(count, self.counts),
            Extent::Counted { turn, from, to } => {
                count - nearest(count, turn, [from.into(), to.into()])
            }
            Extent::Device | Extent::Range(_) => return,
        };
        // Only its low bits are compared.
        self.origin = origin as i32;
    }

    /// The position within a turn, from its low 32 bits, and the number of whole turns by which it has left
    /// the previous turn. Positions range from a turn below zero to a turn above, so that small steps back
    /// and forth do not leave the turn. `None`: far away, without a turn.
    #[inline(always)]
    pub(crate) fn within(&mut self, count: i32) -> Option<(i32, i32)> {
        let within = count.wrapping_sub(self.origin);
        if within.wrapping_add(self.counts).cast_unsigned() <= 2 * self.counts.cast_unsigned() {
            return Some((within, 0));
        }
        cold_path();
        match self.extent {
            Extent::Turn => {}
            // Beyond any range. Without the omitted turns the position is unknown; only the side matters.
            Extent::Counted { .. } => {
                return Some((within.clamp(-Self::MOST_COUNTS, Self::MOST_COUNTS), 0));
            }
            Extent::Device | Extent::Range(_) => return None,
        }
        let turns = within / self.counts;
        self.origin = self.origin.wrapping_add(turns.wrapping_mul(self.counts));
        Some((within % self.counts, turns))
    }

    /// The angle in rad by which positions move when this number of turns is left.
    pub(crate) fn left(&self, turns: i32) -> N {
        /// A larger motion in a tick is a fault.
        const MOST: u32 = 16;
        let mut angle = N::ZERO;
        for _ in 0..turns.unsigned_abs().min(MOST) {
            angle = if turns > 0 { angle.minus(self.angle) } else { angle.plus(self.angle) };
        }
        angle
    }

    /// An angle in rad within a turn; without a turn, the angle itself.
    pub(crate) fn wrapped(&self, angle: f64) -> f64 {
        if self.extent == Extent::Turn { angle % TAU } else { angle }
    }
}

/// The position nearest to a range among those a whole number of turns from `count`; of several, the nearest
/// to `count`.
fn nearest(count: i64, turn: i32, [from, to]: [i64; 2]) -> i64 {
    let away = |count: i64| (from - count).max(count - to).max(0);
    let sign = if count < from { 1 } else { -1 };
    // The last position on this side of the range, or at its end; the next position may be within the range
    // or nearer.
    let here = count + sign * whole_turns(away(count), turn);
    let next = here + sign * i64::from(turn);
    if away(next) < away(here) { next } else { here }
}

/// A count modulo whole turns, toward zero. Digit by digit, once per start: a 64-bit division would take more
/// of a board's flash than the rest of this module.
#[cold]
#[inline(never)]
fn whole_turns(count: i64, turn: i32) -> i64 {
    const DIGIT: u32 = 4;
    let (mut digits, turn) = (count.unsigned_abs(), turn.unsigned_abs());
    let mut rest = 0;
    for _ in 0..u64::BITS / DIGIT {
        digits = digits.rotate_left(DIGIT);
        // A turn has at most 2^28 counts, so one more digit fits 32 bits.
        rest = ((rest << DIGIT) | (digits as u32 % (1 << DIGIT))) % turn;
    }
    count - i64::from(rest) * count.signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By all turns, one after the other.
    #[test]
    fn a_range_is_entered_from_the_nearest_turn() {
        for (turn, from, to) in [(100, -17, 17), (100, 0, 28), (100, 0, 200), (7, 3, 4)] {
            for count in -1000..1000 {
                let away =
                    |turns: i64| (from - count - turns * turn).max(count + turns * turn - to);
                let best = (-1000..=1000).min_by_key(|&turns| (away(turns).max(0), turns.abs()));
                let best = count + best.unwrap() * turn;
                assert_eq!(
                    nearest(count, turn as i32, [from, to]),
                    best,
                    "{count} of {turn}: {from} to {to}"
                );
            }
        }
    }

    #[test]
    fn whole_turns_are_those_of_a_division() {
        for turn in [1, 2, 7, 1000, 16384, (1 << 28) - 1, 1 << 28] {
            for count in [0, 1, 999, 1000, 1001, 1 << 40, i64::MAX, (7 << 32) + 123] {
                for count in [count, -count] {
                    let divided = count / i64::from(turn) * i64::from(turn);
                    assert_eq!(whole_turns(count, turn), divided, "{count} of {turn}");
                }
            }
        }
    }

    #[test]
    fn turns_are_left_out_of_a_position_that_starts_far_away() {
        let mut turn = Turn::<f32>::nearest_to([0.0, TAU / 2.0]);
        turn.set_counts(1000.0).unwrap();
        assert!(turn.set_counts(1000.5).is_err());
        for far in [50_123_i64, -49_877, 123, (7 << 32) + 123 - (7 << 32) % 1000] {
            turn.start_at(far);
            assert_eq!(turn.within(far as i32), Some((123, 0)), "{far}");
            assert_eq!(turn.within((far - 300) as i32), Some((-177, 0)));
        }
        // Farther than a mode's range ever is, it stays on its side.
        turn.start_at(0);
        assert_eq!(turn.within(i32::MAX), Some((Turn::<f32>::MOST_COUNTS, 0)));
        assert_eq!(turn.within(i32::MIN), Some((-Turn::<f32>::MOST_COUNTS, 0)));
    }
}
