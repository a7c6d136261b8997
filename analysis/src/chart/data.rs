//! The numbers of a chart as CSV.

use std::io::Write;
use std::path::Path;

use super::error::ChartError;
use super::picture::Picture;

/// A number or a word of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number with all its digits; empty if it is not finite.
    Number(f64),
    Word(String),
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        Self::Number(number.unwrap_or(f64::NAN))
    }
}

impl From<&str> for Cell {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

impl Cell {
    fn text(&self) -> String {
        match self {
            Self::Number(number) if number.is_finite() => number.to_string(),
            Self::Number(_) => String::new(),
            Self::Word(word) => word.clone(),
        }
    }
}

/// The rows of a table, which are computed as they are written: a map has millions.
pub struct Data {
    header: &'static [&'static str],
    rows: Box<dyn Iterator<Item = Vec<Cell>>>,
}

impl Data {
    /// A table with these names of its columns, units included.
    pub fn new(
        header: &'static [&'static str],
        rows: impl IntoIterator<Item = Vec<Cell>> + 'static,
    ) -> Self {
        Self { header, rows: Box::new(rows.into_iter()) }
    }

    pub fn write(self, path: &Path) -> Result<(), ChartError> {
        let unwritable =
            |source| ChartError::Output { path: path.to_owned(), what: "numbers", source };
        let file = std::fs::File::create(path).map_err(unwritable)?;
        self.write_to(file).map_err(unwritable)
    }

    fn write_to(self, to: impl Write) -> std::io::Result<()> {
        let mut table = csv::Writer::from_writer(to);
        table.write_record(self.header)?;
        for row in self.rows {
            table.write_record(row.iter().map(Cell::text))?;
        }
        table.flush()
    }
}

pub struct Chart {
    pub picture: Picture,
    pub data: Data,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_and_what_is_none_stays_empty() {
        let row = vec![Cell::from(0.1 + 0.2), Cell::from(f64::INFINITY), Cell::from("a, b")];
        let mut file = Vec::new();
        Data::new(&["x (s)", "y", "z"], [row]).write_to(&mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        assert_eq!(text, "x (s),y,z\n0.30000000000000004,,\"a, b\"\n");
    }
}
