//! Named columns of a CSV file, row by row, for recordings and measurements.
//!
//! The first line names the columns, in any order and in any case; columns that are not needed are ignored.
//! Fields are separated by `,`, `;` or tabs, as the first line is; behind `;` and tabs a number may have a
//! decimal comma. A column may state its unit: `time [ms]`, `torque (mNm)`, `torque_mNm`.
//! Every error names the file, and the line and the column of the error, both counted from 1.

use std::cell::Cell;
use std::fs::File;
use std::io::{BufRead, BufReader, Chain, Cursor, Read};
use std::path::Path;
use std::str::FromStr;

use csv::{Position, StringRecord};
use thiserror::Error;

use crate::file::excerpt;

/// Why a file is not a valid table: the file, mostly with a line, and the error there.
#[derive(Debug, Error)]
#[error("{place}: {message}")]
pub struct TableError {
    place: String,
    message: String,
}

impl TableError {
    /// An error of the whole file.
    pub fn of_file(file: &str, message: impl Into<String>) -> Self {
        Self { place: file.to_owned(), message: message.into() }
    }

    /// An error in a line, counted from 1.
    pub fn in_line(file: &str, line: u64, message: impl Into<String>) -> Self {
        Self { place: format!("{file}:{line}"), message: message.into() }
    }

    fn unreadable(file: &str, error: &std::io::Error) -> Self {
        Self::of_file(file, format!("cannot be read: {error}"))
    }
}

/// A column by its names, and its valid values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its possible names, in small letters; the first one present is taken.
    pub names: &'static [&'static str],
    /// The valid values of its fields.
    pub bound: &'static str,
}

/// A unit by the ways to write it, and its size in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    pub names: &'static [&'static str],
    /// SI units in one of it.
    pub factor: f64,
}

/// A column that was found in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundColumn {
    index: usize,
    /// Which of its names it has.
    pub name: &'static str,
    bound: &'static str,
    /// SI units in one of its unit.
    factor: f64,
    /// Whether it states its unit.
    pub has_unit: bool,
}

/// A file after its first line was examined.
type Source<R> = Chain<Cursor<Vec<u8>>, BufReader<R>>;

const LONGEST_HEADER: u64 = 1 << 16;

/// A table of which the header has been read.
#[derive(Debug)]
pub struct Table<R> {
    file: String,
    reader: csv::Reader<Source<R>>,
    header: StringRecord,
    record: StringRecord,
    rows: usize,
    decimal: DecimalMark,
}

/// The decimal mark of the numbers so far.
#[derive(Debug)]
struct DecimalMark {
    /// Whether numbers may have a comma.
    may_be_comma: bool,
    found: Cell<Option<char>>,
}

impl DecimalMark {
    /// The text of a number with a point; `None` where a file mixes points and commas.
    fn with_point(&self, text: &str) -> Option<String> {
        let mark = text.chars().find(|c| *c == '.' || *c == ',' && self.may_be_comma);
        match (mark, self.found.get()) {
            (Some(mark), Some(found)) if mark != found => return None,
            (Some(_), None) => self.found.set(mark),
            _ => {}
        }
        Some(if mark == Some(',') { text.replacen(',', ".", 1) } else { text.to_owned() })
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Row<'t> {
    file: &'t str,
    line: u64,
    fields: &'t StringRecord,
    decimal: &'t DecimalMark,
}

impl Table<File> {
    pub fn open(path: &Path) -> Result<Self, TableError> {
        let file = path.display().to_string();
        let source = File::open(path).map_err(|error| TableError::unreadable(&file, &error))?;
        Self::new(&file, source)
    }
}

impl<R: Read> Table<R> {
    /// A table from anything that can be read; messages call it `file`.
    pub fn new(file: &str, source: R) -> Result<Self, TableError> {
        let mut source = BufReader::new(source);
        let mut first = Vec::new();
        let read = source.by_ref().take(LONGEST_HEADER).read_until(b'\n', &mut first);
        read.map_err(|error| TableError::unreadable(file, &error))?;
        let delimiter = delimiter(&String::from_utf8_lossy(&first))
            .map_err(|message| TableError::in_line(file, 1, message))?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .delimiter(delimiter)
            .from_reader(Cursor::new(first).chain(source));
        let header = reader.headers().map_err(|error| bad_row(file, 1, &error))?.clone();
        let (file, record) = (file.to_owned(), StringRecord::new());
        let decimal = DecimalMark { may_be_comma: delimiter != b',', found: Cell::new(None) };
        Ok(Self { file, reader, header, record, rows: 0, decimal })
    }

    /// The name of the file in messages.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Where a column is, if it is there.
    pub fn find(&self, column: Column) -> Option<FoundColumn> {
        let at = |name: &str| self.header.iter().position(|is| is.eq_ignore_ascii_case(name));
        column.names.iter().find_map(|name| {
            let (index, bound) = (at(name)?, column.bound);
            Some(FoundColumn { index, name, bound, factor: 1.0, has_unit: false })
        })
    }

    /// Where a column is that may state one of these units, if it is there; without a unit it is in SI units.
    pub fn find_in(
        &self,
        column: Column,
        units: &[Unit],
    ) -> Result<Option<FoundColumn>, TableError> {
        let bad = |message: String| TableError::in_line(&self.file, 1, message);
        for name in column.names {
            let mut found: Option<(FoundColumn, &str)> = None;
            for (index, header) in self.header.iter().enumerate() {
                let Some(unit) = unit_behind(header, name, units) else { continue };
                let (bound, has_unit) = (column.bound, !unit.is_empty());
                let factor = match units.iter().find(|known| known.names.contains(&unit)) {
                    Some(known) => known.factor,
                    None if unit.is_empty() => 1.0,
                    None => {
                        return Err(bad(format!(
                            "the column `{}` has the unit `{}`; the units of `{name}` are {}",
                            excerpt(header),
                            excerpt(unit),
                            units.iter().map(|unit| unit.names[0]).collect::<Vec<_>>().join(", ")
                        )));
                    }
                };
                if let Some((_, other)) = found {
                    let (a, b) = (excerpt(other), excerpt(header));
                    return Err(bad(format!(
                        "`{a}` and `{b}` are both `{name}`: rename one of them"
                    )));
                }
                found = Some((FoundColumn { index, name, bound, factor, has_unit }, header));
            }
            if let Some((found, _)) = found {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// Where a column is that may state one of these units.
    pub fn column_in(&self, column: Column, units: &[Unit]) -> Result<FoundColumn, TableError> {
        self.find_in(column, units)?.ok_or_else(|| self.missing(column))
    }

    pub fn column(&self, column: Column) -> Result<FoundColumn, TableError> {
        self.find(column).ok_or_else(|| self.missing(column))
    }

    /// The error for a column that is missing.
    pub fn missing(&self, column: Column) -> TableError {
        let names: Vec<_> = column.names.iter().map(|name| format!("`{name}`")).collect();
        let columns = self.header.iter().map(excerpt).collect::<Vec<_>>().join(", ");
        let columns = if columns.is_empty() { "none".to_owned() } else { excerpt(&columns) };
        let message =
            format!("there is no column {}; the columns are {columns}", names.join(" or "));
        TableError::in_line(&self.file, 1, message)
    }

    /// The next row; `None` at the end.
    pub fn row(&mut self) -> Result<Option<Row<'_>>, TableError> {
        let line = self.reader.position().line();
        match self.reader.read_record(&mut self.record) {
            Ok(false) => Ok(None),
            Ok(true) => {
                self.rows += 1;
                let line = self.record.position().map_or(line, Position::line);
                if self.record == self.header {
                    let message =
                        "the header of line 1 is repeated here: keep one record in a file";
                    return Err(TableError::in_line(&self.file, line, message));
                }
                let (file, fields, decimal) = (&self.file, &self.record, &self.decimal);
                Ok(Some(Row { file, line, fields, decimal }))
            }
            Err(error) => Err(bad_row(&self.file, line, &error)),
        }
    }

    /// Checks that at least this many rows have been read.
    pub fn at_least(&self, least: usize) -> Result<(), TableError> {
        if self.rows >= least {
            return Ok(());
        }
        let rows = self.rows;
        let few =
            format!("{rows} rows below the header are too few; there must be at least {least}");
        Err(TableError::of_file(&self.file, few))
    }
}

impl Row<'_> {
    /// The field in a column as a number that its bound admits.
    pub fn number<T: FromStr>(
        &self,
        place: FoundColumn,
        admits: impl Fn(&T) -> bool,
    ) -> Result<T, TableError> {
        let Some(text) = self.decimal.with_point(self.text(place)) else {
            let bound = format!("{} with the decimal mark of the rows before", place.bound);
            return Err(self.bad(place, &bound));
        };
        text.parse().ok().filter(admits).ok_or_else(|| self.bad(place, place.bound))
    }

    /// The same in SI units.
    pub fn in_si(
        &self,
        place: FoundColumn,
        admits: impl Fn(&f64) -> bool,
    ) -> Result<f64, TableError> {
        Ok(place.factor * self.number::<f64>(place, |value| admits(&(place.factor * value)))?)
    }

    /// Its line in the file, counted from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// The error for a field in a column that conflicts with the rows before.
    pub fn bad(&self, place: FoundColumn, bound: &str) -> TableError {
        let (column, name, value) = (place.index + 1, place.name, excerpt(self.text(place)));
        let message =
            format!("column {column}, `{name}`: `{value}` is out of bounds; it must be {bound}");
        TableError::in_line(self.file, self.line, message)
    }

    pub fn text(&self, place: FoundColumn) -> &str {
        self.fields.get(place.index).unwrap_or_default()
    }
}

/// The separator of a first line, outside of quotes and brackets.
fn delimiter(first: &str) -> Result<u8, String> {
    let (mut depth, mut is_quoted) = (0_i32, false);
    let mut outside = first.chars().filter(|c| {
        match c {
            '"' => is_quoted = !is_quoted,
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            _ => {}
        }
        depth <= 0 && !is_quoted
    });
    let found: String = outside.by_ref().filter(|c| [',', ';', '\t'].contains(c)).collect();
    match (found.contains(';'), found.contains(','), found.contains('\t')) {
        (true, false, false) => Ok(b';'),
        (false, false, true) => Ok(b'\t'),
        // A tab behind a comma is a space.
        (false, _, _) => Ok(b','),
        _ => Err(format!(
            "`{}` has `;` beside `,` or a tab: separate the columns with one of them",
            excerpt(first)
        )),
    }
}

/// The unit of a header that has this name: empty without a unit, `None` for another name.
fn unit_behind<'h>(header: &'h str, name: &str, units: &[Unit]) -> Option<&'h str> {
    let begin = header.get(..name.len()).filter(|begin| begin.eq_ignore_ascii_case(name))?;
    let rest = header[begin.len()..].trim();
    if rest.is_empty() {
        return Some("");
    }
    let in_brackets =
        |open: char, close: char| Some(rest.strip_prefix(open)?.strip_suffix(close)?.trim());
    in_brackets('[', ']').or_else(|| in_brackets('(', ')')).or_else(|| {
        // Behind `_` only a known unit is one: `time_stamp` is another column.
        let unit = rest.strip_prefix('_')?;
        units.iter().any(|known| known.names.contains(&unit)).then_some(unit)
    })
}

fn bad_row(file: &str, line: u64, error: &csv::Error) -> TableError {
    let message = match error.kind() {
        csv::ErrorKind::Io(error) => return TableError::unreadable(file, error),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} fields; the header has {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
        _ => excerpt(&error.to_string()),
    };
    TableError::in_line(file, error.position().map_or(line, Position::line), message)
}
