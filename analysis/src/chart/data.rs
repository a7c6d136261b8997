//! The numbers of a chart as CSV.

use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

use super::error::ChartError;
use super::picture::Picture;

/// A word of a table, or a number with all its digits; empty if it is not finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell(String);

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self(if number.is_finite() { number.to_string() } else { String::new() })
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.unwrap_or(f64::NAN).into()
    }
}

impl From<&str> for Cell {
    fn from(word: &str) -> Self {
        Self(word.to_owned())
    }
}

/// The rows of a table, which are computed as they are written: a map has millions.
pub struct Data {
    header: Cow<'static, str>,
    rows: Box<dyn Iterator<Item = Vec<Cell>>>,
}

impl Data {
    /// A table whose first line has the names of its columns, units included, with commas between them.
    pub fn new(
        header: impl Into<Cow<'static, str>>,
        rows: impl IntoIterator<Item = Vec<Cell>> + 'static,
    ) -> Self {
        Self { header: header.into(), rows: Box::new(rows.into_iter()) }
    }

    pub fn write(self, path: &Path) -> Result<(), ChartError> {
        let unwritable =
            |source| ChartError::Output { path: path.to_owned(), what: "numbers", source };
        let file = std::fs::File::create(path).map_err(unwritable)?;
        self.write_to(file).map_err(unwritable)
    }

    fn write_to(self, to: impl Write) -> std::io::Result<()> {
        let mut table = csv::Writer::from_writer(to);
        table.write_record(self.header.split(','))?;
        for row in self.rows {
            table.write_record(row.iter().map(|cell| &cell.0))?;
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
        Data::new("x (s),y,z", [row]).write_to(&mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        assert_eq!(text, "x (s),y,z\n0.30000000000000004,,\"a, b\"\n");
    }
}
