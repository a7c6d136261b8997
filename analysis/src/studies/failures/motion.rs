//! The outcome of a motion.

use std::fmt;

use haptic_servo::words;
use serde::Serialize;

use crate::quantity::significant;

words! {
    /// The outcome of a motion.
    #[derive(Serialize)]
    Outcome {
    /// It comes to rest.
    #[serde(rename = "rests")]
    Converges "rests",
    /// It persists, but is smaller.
    #[serde(rename = "hums")]
    LimitCycles "hums",
    /// It becomes larger than it was.
    #[serde(rename = "grows")]
    Diverges "grows",
    }
}

/// The swing of a motion at its start and at its end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Motion {
    /// Largest less smallest position in the first tenth of the samples, in rad.
    pub first: f64,
    /// The same in the last tenth; infinite (null in JSON) if the motion has left the range of numbers.
    pub last: f64,
}

impl Motion {
    /// From positions in rad: `asked` of them, or fewer if the motion leaves the range.
    pub fn of(positions: &[f64], asked: usize) -> Self {
        let tenth = (asked / 10).max(1).min(positions.len());
        let first = swing(&positions[..tenth]);
        let complete = positions.len() >= asked;
        let last = if complete { swing(&positions[asked - tenth..asked]) } else { f64::INFINITY };
        Self { first, last }
    }

    /// The outcome.
    pub fn outcome(&self) -> Outcome {
        /// Fraction of the first swing below which a motion counts as ended.
        const STILL: f64 = 1e-6;
        if !self.last.is_finite() || self.last > self.first {
            Outcome::Diverges
        } else if self.last <= STILL * self.first {
            Outcome::Converges
        } else {
            Outcome::LimitCycles
        }
    }
}

impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (first, last) = (significant(self.first, 3), significant(self.last, 3));
        write!(f, "{}: {first} to {last} rad", self.outcome().as_str())
    }
}

/// Largest less smallest; infinite if one of them is not finite.
pub fn swing(positions: &[f64]) -> f64 {
    if !positions.iter().all(|position| position.is_finite()) {
        return f64::INFINITY;
    }
    let largest = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = positions.iter().copied().fold(f64::INFINITY, f64::min);
    (largest - smallest).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_are_told_apart() {
        let motion = |factor: f64| -> Vec<f64> {
            (0..1000).map(|k| factor.powi(k) * f64::from(k % 2)).collect()
        };
        let end = |positions: &[f64]| Motion::of(positions, 1000).outcome();
        assert_eq!(end(&motion(0.98)), Outcome::Converges);
        assert_eq!(end(&motion(0.9995)), Outcome::LimitCycles);
        assert_eq!(end(&motion(1.001)), Outcome::Diverges);
        assert_eq!(end(&motion(0.98)[..999]), Outcome::Diverges);
        assert_eq!(end(&[f64::NAN; 1000]), Outcome::Diverges);
    }
}
