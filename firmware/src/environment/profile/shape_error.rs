//! The reasons why shapes do not make a torque profile.

use crate::text::{Sentence, error_with_sentence, push};

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
            Self::Empty => push!(t, "a torque profile needs a shape"),
            Self::Number { shape, name, value, bound } => {
                push!(t, "shape " {shape} ": `" {name} "` is " {value} ", and must be " {bound});
            }
            Self::Knot { shape, knot, value, bound, limit } => {
                push!(t, "shape " {shape} ", knot " {knot} ": " {value} " must be " {bound});
                if let Some(limit) = limit {
                    push!(t, " " {limit});
                }
            }
            Self::Endless { shape } => push!(t,
                "shape " {shape} " does not repeat a whole number of times in a turn, so that it needs end stops to \
                 keep the angle within its range"),
            Self::TooFewKnots { knots, needed } => push!(t,
                "the table has " {knots} " knots, and its narrowest straight piece takes " {needed}),
            Self::SecondSnap { shape } => push!(t,
                "shape " {shape} " is the second one with a snap point, and a torque profile has one at most"),
            Self::Flat => push!(t, "the torque profile has no torque anywhere"),
            Self::Mean { mean } => push!(t,
                "the mean of the torque over a period is " {mean}
                " N m, and must be 0: it would turn the device for ever, as a motor does"),
        }
        t
    }
}

error_with_sentence!(ShapeError);
