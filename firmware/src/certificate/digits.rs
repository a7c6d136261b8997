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
    /// Those of a value, rounded away from the values that fail.
    pub const fn of(value: f64, relation: Relation) -> Self {
        let (mut power, mut scaled) = (1.0, value);
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
