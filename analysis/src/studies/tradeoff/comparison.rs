//! Comparisons: their columns, and which values are the better ones.

use crate::table::Column;

/// What every number of a table is.
pub const NUMBER: &str = "a number of 0 or more, `inf`, or nothing where there is none";

/// Which values of a column are the good ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The smaller the better.
    Minimize,
    /// The greater the better.
    Maximize,
}

/// A column of a table that is drawn along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// The column in the file.
    pub column: Column,
    /// Its name and its unit, as on the axis.
    pub label: &'static str,
    /// Which way is better.
    pub direction: Direction,
    /// Values up to this one are all the same and are drawn there: what the reference itself is good
    /// for, or half of the smallest count. Above 0, because axes are logarithmic.
    pub floor: f64,
    /// What a value at the floor is called in the picture.
    pub at_floor: &'static str,
}

impl Axis {
    /// A column of numbers of which the smaller are the better.
    pub const fn least(names: &'static [&'static str], label: &'static str) -> Self {
        let column = Column { names, bound: NUMBER };
        Self {
            column,
            label,
            direction: Direction::Minimize,
            floor: f64::MIN_POSITIVE,
            at_floor: "0",
        }
    }

    /// A column of numbers of which the greater are the better.
    pub const fn most(names: &'static [&'static str], label: &'static str) -> Self {
        Self { direction: Direction::Maximize, ..Self::least(names, label) }
    }

    /// The same with all values up to `floor` taken for the same, called by these words.
    pub const fn floored(self, floor: f64, at_floor: &'static str) -> Self {
        Self { floor, at_floor, ..self }
    }

    /// Whether the first value is better than the second, beyond the floor.
    pub fn is_better(&self, value: f64, than: f64) -> bool {
        let [value, than] = [value, than].map(|value| value.max(self.floor));
        match self.direction {
            Direction::Minimize => value < than,
            Direction::Maximize => value > than,
        }
    }
}

/// A comparison and its columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Name of its files, without the extension.
    pub name: &'static str,
    /// Above its picture.
    pub title: &'static str,
    /// What a method costs.
    pub cost: Axis,
    /// What one gets for it: a panel of the picture each.
    pub errors: &'static [Axis],
    /// Columns that are kept but not drawn.
    pub others: &'static [Column],
}

impl Comparison {
    /// The columns of numbers in the order of the [values](super::Method::values) of a method.
    pub fn columns(&self) -> impl Iterator<Item = Column> + use<> {
        let drawn = std::iter::once(self.cost.column).chain(self.errors.iter().map(|e| e.column));
        drawn.chain(self.others.iter().copied())
    }
}
