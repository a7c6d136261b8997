//! Numbers of three significant digits: what a remedy says.

use super::remedy::Relation;

/// How far off a digit a number may be to count as having no more: what scaling it by tens rounds.
const ROUNDED: f64 = 1e-9;

/// A positive number of three digits.
#[derive(Clone, Copy)]
pub(super) struct Digits {
    whole: u64,
    power: f64,
    divisor: f64,
}

impl Digits {
    /// Those of a value, rounded away from the values that fail; of what is not positive or not
    /// finite, those of the nearest number that is.
    pub const fn of(value: f64, relation: Relation) -> Self {
        let (mut power, mut scaled) = (1.0, value.max(f64::MIN_POSITIVE).min(f64::MAX));
        while scaled < 100.0 {
            scaled *= 10.0;
            power *= 10.0;
        }
        let mut divisor = 1.0;
        while scaled >= 1000.0 {
            scaled /= 10.0;
            divisor *= 10.0;
        }
        let whole = match relation {
            Relation::AtMost => (scaled + ROUNDED) as u64,
            _ => (scaled - ROUNDED) as u64 + 1,
        };
        Self { whole, power, divisor }
    }

    /// The number.
    pub const fn value(self) -> f64 {
        self.whole as f64 / self.power * self.divisor
    }

    /// The next one on the side of the values that fail.
    pub const fn nearer(self, relation: Relation) -> Self {
        self.further(match relation {
            Relation::AtMost => Relation::AtLeast,
            _ => Relation::AtMost,
        })
    }

    /// The next one on the other side.
    pub const fn further(self, relation: Relation) -> Self {
        let whole = match relation {
            Relation::AtMost => self.whole - 1,
            _ => self.whole + 1,
        };
        Self { whole, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_rounded_away_from_what_fails() {
        let both = [Relation::AtMost, Relation::AtLeast];
        assert_eq!(both.map(|relation| Digits::of(23.96, relation).value()), [23.9, 24.0]);
        assert_eq!(both.map(|relation| Digits::of(2e5, relation).value()), [2e5, 2e5]);
        assert_eq!(Digits::of(23.9, Relation::AtMost).further(Relation::AtMost).value(), 23.8);
        assert_eq!(Digits::of(23.9, Relation::AtMost).nearer(Relation::AtMost).value(), 24.0);
    }

    /// What has no digits is not searched for them without end.
    #[test]
    fn every_double_has_some() {
        let extremes = [0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MAX, 5e-324];
        for value in extremes {
            for relation in [Relation::AtMost, Relation::AtLeast] {
                let whole = Digits::of(value, relation).whole;
                assert!((99..=1000).contains(&whole), "{value}: {whole}");
            }
        }
    }
}
