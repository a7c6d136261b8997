//! Named columns of a CSV file, row by row, for recordings and measurements.
//!
//! The first line names the columns, in any order and in any case; columns that are not needed are ignored.
//! Every error names the file, and the line and the column of the error, both counted from 1.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::str::FromStr;

use csv::{Position, StringRecord};
use thiserror::Error;

use crate::file::excerpt;

/// Why a file is not a valid table.
#[derive(Debug, Error)]
pub enum TableError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {message}")]
    Unreadable {
        /// The file.
        file: String,
        /// The cause.
        message: String,
    },
    /// A column is missing.
    #[error("{file}:1: there is no column {wanted}; the columns are {columns}")]
    NoColumn {
        /// The file.
        file: String,
        /// The names that it could have.
        wanted: String,
        /// The columns that there are.
        columns: String,
    },
    /// A row is not text, or has another number of fields than the header.
    #[error("{file}:{line}: {message}")]
    BadRow {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The error in it.
        message: String,
    },
    /// A field is invalid in its column.
    #[error(
        "{file}:{line}: column {column}, `{name}`: `{value}` is out of bounds; it must be {bound}"
    )]
    BadField {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The column's number.
        column: usize,
        /// The column's name.
        name: &'static str,
        /// The text of the field.
        value: String,
        /// The valid values.
        bound: String,
    },
    /// Too short.
    #[error("{file}: {rows} rows below the header are too few; there must be at least {least}")]
    TooShort {
        /// The file.
        file: String,
        /// The number of rows.
        rows: usize,
        /// The least number of rows.
        least: usize,
    },
}

/// A column by its names, and its valid values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its possible names, in small letters; the first one present is taken.
    pub names: &'static [&'static str],
    /// The valid values of its fields.
    pub bound: &'static str,
}

/// A column that was found in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoundColumn {
    index: usize,
    /// Which of its names it has.
    pub name: &'static str,
    bound: &'static str,
}

/// A table of which the header has been read.
#[derive(Debug)]
pub struct Table<R> {
    file: String,
    reader: csv::Reader<R>,
    header: StringRecord,
    record: StringRecord,
    rows: usize,
}

/// A row of a table.
#[derive(Clone, Copy, Debug)]
pub struct Row<'t> {
    file: &'t str,
    line: u64,
    fields: &'t StringRecord,
}

impl Table<File> {
    /// Opens a file.
    ///
    /// # Errors
    /// Where it cannot be read, or its first line is not text.
    pub fn open(path: &Path) -> Result<Self, TableError> {
        let file = path.display().to_string();
        match File::open(path) {
            Ok(source) => Self::new(&file, source),
            Err(error) => Err(TableError::Unreadable { file, message: error.to_string() }),
        }
    }
}

impl<R: Read> Table<R> {
    /// A table from anything that can be read; messages call it `file`.
    ///
    /// # Errors
    /// As [`Table::open`].
    pub fn new(file: &str, source: R) -> Result<Self, TableError> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(source);
        let header = reader.headers().map_err(|error| bad_row(file, 1, &error))?.clone();
        let (file, record) = (file.to_owned(), StringRecord::new());
        Ok(Self { file, reader, header, record, rows: 0 })
    }

    /// The name of the file in messages.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Where a column is, if it is there.
    pub fn find(&self, column: Column) -> Option<FoundColumn> {
        let at = |name: &str| self.header.iter().position(|is| is.eq_ignore_ascii_case(name));
        column
            .names
            .iter()
            .find_map(|name| Some(FoundColumn { index: at(name)?, name, bound: column.bound }))
    }

    /// Where a column is.
    ///
    /// # Errors
    /// Where it is missing.
    pub fn column(&self, column: Column) -> Result<FoundColumn, TableError> {
        self.find(column).ok_or_else(|| {
            let names: Vec<_> = column.names.iter().map(|name| format!("`{name}`")).collect();
            let columns = self.header.iter().map(excerpt).collect::<Vec<_>>().join(", ");
            let columns = if columns.is_empty() { "none".to_owned() } else { excerpt(&columns) };
            let (file, wanted) = (self.file.clone(), names.join(" or "));
            TableError::NoColumn { file, wanted, columns }
        })
    }

    /// The next row; `None` at the end.
    ///
    /// # Errors
    /// Where it cannot be read, is not text, or has another number of fields than the header.
    pub fn row(&mut self) -> Result<Option<Row<'_>>, TableError> {
        let line = self.reader.position().line();
        match self.reader.read_record(&mut self.record) {
            Ok(false) => Ok(None),
            Ok(true) => {
                self.rows += 1;
                let line = self.record.position().map_or(line, Position::line);
                Ok(Some(Row { file: &self.file, line, fields: &self.record }))
            }
            Err(error) => Err(bad_row(&self.file, line, &error)),
        }
    }

    /// Checks that at least this many rows have been read.
    ///
    /// # Errors
    /// Where they were fewer.
    pub fn at_least(&self, least: usize) -> Result<(), TableError> {
        match self.rows {
            rows if rows < least => {
                Err(TableError::TooShort { file: self.file.clone(), rows, least })
            }
            _ => Ok(()),
        }
    }
}

impl Row<'_> {
    /// The field in a column as a number that its bound admits.
    ///
    /// # Errors
    /// Where the field is not such a number.
    pub fn number<T: FromStr>(
        &self,
        place: FoundColumn,
        admits: impl Fn(&T) -> bool,
    ) -> Result<T, TableError> {
        let value = self.text(place).parse().ok().filter(admits);
        value.ok_or_else(|| self.bad(place, place.bound))
    }

    /// The error for a field in a column that conflicts with the rows before.
    pub fn bad(&self, place: FoundColumn, bound: &str) -> TableError {
        TableError::BadField {
            file: self.file.to_owned(),
            line: self.line,
            column: place.index + 1,
            name: place.name,
            value: excerpt(self.text(place)),
            bound: bound.to_owned(),
        }
    }

    /// The field in a column.
    pub fn text(&self, place: FoundColumn) -> &str {
        self.fields.get(place.index).unwrap_or_default()
    }
}

fn bad_row(file: &str, line: u64, error: &csv::Error) -> TableError {
    let file = file.to_owned();
    let message = match error.kind() {
        csv::ErrorKind::Io(error) => {
            return TableError::Unreadable { file, message: error.to_string() };
        }
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} fields; the header has {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
        _ => excerpt(&error.to_string()),
    };
    TableError::BadRow { file, line: error.position().map_or(line, Position::line), message }
}
