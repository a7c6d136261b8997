//! Numbers of few significant digits, for remedies.

/// Relative deviation at which a number still counts as having no more digits: the rounding of scaling by
/// powers of ten.
const ROUNDED: f64 = 1e-12;
/// The largest power of ten that is a double: a whole number times it, or over it, is rounded once.
const LARGEST_POWER: f64 = 1e22;

/// The side of a value on which a scene passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// It passes with smaller values.
    Below,
    /// It passes with larger values.
    Above,
}

impl Side {
    pub const fn other(self) -> Self {
        match self {
            Self::Below => Self::Above,
            Self::Above => Self::Below,
        }
    }
}

/// A positive number of a few digits, three by default.
#[derive(Clone, Copy)]
pub(crate) struct Digits {
    whole: u64,
    power: f64,
    divisor: f64,
}

impl Digits {
    /// The largest number of digits that [`Text`](crate::text::Text) writes so that they read back as the
    /// same number.
    pub const MOST: u32 = 9;

    /// Three digits of a value, rounded to the side that passes; for a value that is not positive and finite,
    /// the nearest such value.
    pub const fn of(value: f64, side: Side) -> Self {
        Self::so_many(3, value, side)
    }

    /// `count` digits of a value, rounded in the same way.
    pub const fn so_many(count: u32, value: f64, side: Side) -> Self {
        let end = 10_u64.pow(count) as f64;
        let (mut power, mut scaled) = (1.0, value.max(f64::MIN_POSITIVE).min(f64::MAX));
        while scaled < end / 10.0 {
            scaled *= 10.0;
            power *= 10.0;
        }
        let mut divisor = 1.0;
        while scaled >= end {
            scaled /= 10.0;
            divisor *= 10.0;
        }
        let whole = match side {
            Side::Below => (scaled + scaled * ROUNDED) as u64,
            Side::Above => (scaled - scaled * ROUNDED) as u64 + 1,
        };
        Self { whole, power, divisor }
    }

    /// The number.
    pub const fn value(self) -> f64 {
        self.whole as f64 / self.power * self.divisor
    }

    /// Whether the number is the double nearest to the digits, so that a text of them is read as
    /// it: true of all but the largest and smallest.
    pub const fn are_read_back(self) -> bool {
        self.power <= LARGEST_POWER && self.divisor <= LARGEST_POWER
    }

    /// The next number on the side of the failing values.
    pub const fn nearer(self, side: Side) -> Self {
        self.further(side.other())
    }

    /// The next number on the side of the passing values.
    pub const fn further(self, side: Side) -> Self {
        let whole = match side {
            Side::Below => self.whole - 1,
            Side::Above => self.whole + 1,
        };
        Self { whole, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Text;

    const BOTH: [Side; 2] = [Side::Below, Side::Above];

    #[test]
    fn digits_are_rounded_away_from_what_fails() {
        assert_eq!(BOTH.map(|side| Digits::of(23.96, side).value()), [23.9, 24.0]);
        assert_eq!(BOTH.map(|side| Digits::of(2e5, side).value()), [2e5, 2e5]);
        assert_eq!(Digits::of(23.9, Side::Below).further(Side::Below).value(), 23.8);
        assert_eq!(Digits::of(23.9, Side::Below).nearer(Side::Below).value(), 24.0);
        let more = |count| Digits::so_many(count, 0.123_456_789_7, Side::Below).value();
        assert_eq!([4, 6, 9].map(more), [0.1234, 0.123456, 0.123456789]);
        assert_eq!(Digits::so_many(9, 44.0, Side::Below).value(), 44.0);
    }

    /// The search ends also for a number without such digits.
    #[test]
    fn every_double_has_some() {
        let extremes = [0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MAX, 5e-324];
        for value in extremes {
            for side in BOTH {
                let whole = Digits::of(value, side).whole;
                assert!((99..=1000).contains(&whole), "{value}: {whole}");
            }
        }
    }

    #[test]
    fn digits_are_read_as_the_number_that_they_are() {
        let mut seen = 0;
        for step in 0..40_000 {
            let value = 10.0_f64.powf(-30.0 + 0.0015 * f64::from(step));
            for count in [3, 5, Digits::MOST] {
                for side in BOTH {
                    let digits = Digits::so_many(count, value, side);
                    let mut text = Text::<24>::new();
                    text.push_number(digits.value());
                    let is_same = text.as_str().parse() == Ok(digits.value());
                    assert!(is_same || !digits.are_read_back(), "{} {value}", text.as_str());
                    seen += u32::from(digits.are_read_back());
                }
            }
        }
        assert!(seen > 100_000, "{seen}");
    }
}
