//! The index of an encoder: one pulse per turn.

/// An encoder's third output, by the counts of the other two, in the direction in which the board counts up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderIndex {
    /// Counts of a turn.
    pub counts_per_turn: i64,
    /// Position of the beginning of the pulse in a turn.
    pub at: i64,
    /// Width of the pulse in counts.
    pub width: i64,
    /// Position of the encoder.
    pub position: i64,
}

impl EncoderIndex {
    /// The index of an encoder at zero.
    pub fn new(counts_per_turn: i64, at: i64, width: i64) -> Self {
        Self { counts_per_turn, at, width, position: 0 }
    }

    /// Whether the output is high.
    fn is_high(&self) -> bool {
        (self.position - self.at).rem_euclid(self.counts_per_turn) < self.width
    }

    /// Turns the encoder; returns the number of counts until the output's last rise, if it rose.
    pub fn turn(&mut self, counts: i32) -> Option<i32> {
        let step = counts.signum();
        let mut rose = None;
        for passed in 1..=counts.abs() {
            let was_high = self.is_high();
            self.position += i64::from(step);
            if self.is_high() && !was_high {
                rose = Some(passed * step);
            }
        }
        rose
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_rises_once_a_turn_on_the_side_from_which_it_is_met() {
        let mut index = EncoderIndex::new(1000, 30, 2);
        assert_eq!((index.turn(29), index.turn(1), index.turn(1)), (None, Some(1), None));
        assert_eq!((index.turn(1), index.turn(-1)), (None, Some(-1)));
        // Down to its other end, a turn below, and round.
        assert_eq!((index.turn(-999), index.position), (None, -968));
        assert_eq!((index.turn(-1), index.turn(1000)), (Some(-1), Some(999)));
        assert_eq!(index.turn(2500), Some(1999));
    }
}
