//! Comparisons and their columns, in each of which smaller numbers are better.

use crate::table::Column;

/// A column of a table for an axis of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    /// The name of its column in the file.
    pub name: &'static str,
    /// Name and unit on the axis.
    pub label: &'static str,
    /// Values up to this floor count as equal and are drawn there: the precision of the reference, or half of
    /// the smallest count. Above 0, because axes are logarithmic.
    pub floor: f64,
    /// The name of the floor in the chart.
    pub at_floor: &'static str,
}

impl Axis {
    /// A column with this name in the file and this name with its unit on the axis.
    pub const fn new(name: &'static str, label: &'static str) -> Self {
        Self { name, label, floor: f64::MIN_POSITIVE, at_floor: "0" }
    }

    /// The same with a floor and its name.
    pub const fn floored(self, floor: f64, at_floor: &'static str) -> Self {
        Self { floor, at_floor, ..self }
    }

    /// Whether the first value is better than the second, beyond the floor.
    pub fn is_better(&self, value: f64, than: f64) -> bool {
        value.max(self.floor) < than.max(self.floor)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Comparison {
    /// Name of its files, without the extension.
    pub name: &'static str,
    pub title: &'static str,
    pub cost: Axis,
    /// The errors, with one panel each.
    pub errors: &'static [Axis],
    /// Columns that are kept but not drawn.
    pub others: &'static [&'static str],
    /// Its kept table, as CSV.
    pub kept: &'static [u8],
}

impl Comparison {
    /// The columns of numbers in the order of the [values](super::Method::values) of a method.
    pub fn columns(&'static self) -> impl Iterator<Item = Column> {
        let drawn = std::iter::once(&self.cost.name).chain(self.errors.iter().map(|e| &e.name));
        let bound = "a number of 0 or more, `inf`, or nothing where there is none";
        let column = move |name| Column { names: std::slice::from_ref(name), bound };
        drawn.chain(self.others).map(column)
    }
}
