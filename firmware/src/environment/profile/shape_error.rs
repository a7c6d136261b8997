//! The reasons why shapes do not make a torque profile.

use core::fmt;

use crate::text::Sentence;

/// The reason why shapes do not make a torque profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeError {
    /// There is no shape.
    Empty,
    /// A number is out of its bound.
    Number {
        /// Which shape, from 0.
        shape: usize,
        /// Which number of it.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        bound: &'static str,
    },
    /// A knot of a table is out of its bound.
    Knot {
        /// Which shape, from 0.
        shape: usize,
        /// Which knot of it, from 0.
        knot: usize,
        /// The invalid number of the knot.
        value: f64,
        /// What it must be.
        bound: &'static str,
        /// The number at the end of the text of `bound`.
        limit: Option<f64>,
    },
    /// A shape does not repeat within a turn, and there are no end stops.
    Endless {
        /// Which shape, from 0.
        shape: usize,
    },
    /// The table's cells are wider than the narrowest straight piece.
    TooFewKnots {
        /// The number of knots.
        knots: usize,
        /// The number of knots needed.
        needed: f64,
    },
    /// A second shape with a snap point.
    SecondSnap {
        /// Which shape, from 0.
        shape: usize,
    },
    /// The torque is zero everywhere.
    Flat,
    /// The mean torque of a profile without ends is not zero: it would be a motor.
    Mean {
        /// The mean in N m.
        mean: f64,
    },
}

impl ShapeError {
    /// The error as a sentence, the same at compile time and on the host.
    pub const fn sentence(&self) -> Sentence {
        let mut t = Sentence::new();
        match *self {
            Self::Empty => t.push("a torque profile needs a shape"),
            Self::Number { shape, name, value, bound } => {
                t.push("shape ");
                t.push_number(shape as f64);
                t.push(": `");
                t.push(name);
                t.push("` is ");
                t.push_number(value);
                t.push(", and must be ");
                t.push(bound);
            }
            Self::Knot { shape, knot, value, bound, limit } => {
                t.push("shape ");
                t.push_number(shape as f64);
                t.push(", knot ");
                t.push_number(knot as f64);
                t.push(": ");
                t.push_number(value);
                t.push(" must be ");
                t.push(bound);
                if let Some(limit) = limit {
                    t.push(" ");
                    t.push_number(limit);
                }
            }
            Self::Endless { shape } => {
                t.push("shape ");
                t.push_number(shape as f64);
                t.push(
                    " does not repeat a whole number of times in a turn, so that it needs end stops to keep \
                     the angle within its range",
                );
            }
            Self::TooFewKnots { knots, needed } => {
                t.push("the table has ");
                t.push_number(knots as f64);
                t.push(" knots, and its narrowest straight piece takes ");
                t.push_number(needed);
            }
            Self::SecondSnap { shape } => {
                t.push("shape ");
                t.push_number(shape as f64);
                t.push(
                    " is the second one with a snap point, and a torque profile has one at most",
                );
            }
            Self::Flat => t.push("the torque profile has no torque anywhere"),
            Self::Mean { mean } => {
                t.push("the mean of the torque over a period is ");
                t.push_number(mean);
                t.push(" N m, and must be 0: it would turn the device for ever, as a motor does");
            }
        }
        t
    }
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence().as_str())
    }
}

impl core::error::Error for ShapeError {}
