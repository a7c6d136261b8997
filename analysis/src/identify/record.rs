//! A recorded measurement: time, commanded torque and counts, one row a tick.

use std::path::Path;

use thiserror::Error;

use crate::file::excerpt;

/// How far a row's time may be from its tick, as a part of the period: a slip of a whole tick is
/// found, the rounding of printed decimals is not taken for one.
const JITTER: f64 = 0.25;

/// A measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Sampling period in s.
    pub period: f64,
    /// Torque in N m that is commanded from each tick until the next.
    pub torque: Vec<f64>,
    /// Counts read at each tick.
    pub counts: Vec<f64>,
    /// Frequency in Hz that the torque has at each tick, 0 where it has none; `None` where the
    /// record does not say.
    pub frequency: Option<Vec<f64>>,
}

/// Why a file is no record. Lines and columns are counted from 1.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The file cannot be opened.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// Why.
        source: csv::Error,
    },
    /// A column is missing.
    #[error("{file}:1: there is no column {wanted}; the columns are {columns}")]
    NoColumn {
        /// The file.
        file: String,
        /// What was looked for.
        wanted: &'static str,
        /// The columns that there are.
        columns: String,
    },
    /// A row is not valid CSV, or has another number of fields than the header.
    #[error("{file}:{line}: {message}")]
    BadRow {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// What is wrong with it.
        message: String,
    },
    /// A field is not what its column holds.
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
        /// What stands there.
        value: String,
        /// What must stand there.
        bound: String,
    },
    /// Too short.
    #[error(
        "{file}: {rows} rows below the header are no record; there must be at least {LEAST_ROWS}"
    )]
    TooShort {
        /// The file.
        file: String,
        /// How many there are.
        rows: usize,
    },
}

/// Fewest rows of a record.
pub const LEAST_ROWS: usize = 16;

const TIME: &[&str] = &["time", "time_s", "t"];
const TORQUE: &[&str] = &["torque", "torque_nm"];
const COUNTS: &[&str] = &["counts", "count"];
const FREQUENCY: &[&str] = &["frequency", "frequency_hz"];

/// Reads the columns `time` (s), `torque` (N m), `counts` and, where it is there, `frequency` (Hz)
/// of a CSV file with a header; other columns are passed over. The time must go on by the same
/// period from row to row.
pub fn load(path: &Path) -> Result<Record, RecordError> {
    let file = path.display().to_string();
    match csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path) {
        Ok(reader) => read(&file, reader),
        Err(source) => Err(RecordError::Unreadable { file, source }),
    }
}

/// The same from anything that can be read; messages call it `file`.
pub fn parse(file: &str, text: impl std::io::Read) -> Result<Record, RecordError> {
    read(file, csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text))
}

fn read<R: std::io::Read>(file: &str, mut reader: csv::Reader<R>) -> Result<Record, RecordError> {
    let header = reader.headers().map_err(|error| bad_row(file, 1, &error))?.clone();
    let column = |names: &'static [&'static str], wanted: &'static str| {
        find(&header, names).ok_or_else(|| no_column(file, wanted, &header))
    };
    let time = column(TIME, "`time` (s)")?;
    let torque = column(TORQUE, "`torque` (N m)")?;
    let counts = column(COUNTS, "`counts`")?;
    let frequency = find(&header, FREQUENCY);

    let mut times = Times::default();
    let mut record = Record {
        period: 0.0,
        torque: vec![],
        counts: vec![],
        frequency: frequency.map(|_| vec![]),
    };
    let mut row = csv::StringRecord::new();
    loop {
        let line = reader.position().line();
        match reader.read_record(&mut row) {
            Ok(false) => break,
            Ok(true) => {}
            Err(error) => return Err(bad_row(file, line, &error)),
        }
        let row =
            Row { file, line: row.position().map_or(line, csv::Position::line), fields: &row };
        times.add(&row, time)?;
        record.torque.push(row.number(
            torque,
            "torque",
            "a finite number in N m",
            f64::is_finite,
        )?);
        let is_count = |value: f64| value.fract() == 0.0 && value.abs() < 9e15;
        record.counts.push(row.number(counts, "counts", "a whole number", is_count)?);
        if let (Some(column), Some(values)) = (frequency, &mut record.frequency) {
            let bound = "a finite number of Hz, 0 or more";
            let is_frequency = |value: f64| value.is_finite() && value >= 0.0;
            values.push(row.number(column, "frequency", bound, is_frequency)?);
        }
    }
    record.period = times.period();
    match record.counts.len() {
        rows if rows < LEAST_ROWS => Err(RecordError::TooShort { file: file.to_owned(), rows }),
        _ => Ok(record),
    }
}

/// The times so far, which must be those of evenly spaced ticks.
#[derive(Default)]
struct Times {
    first: f64,
    latest: f64,
    rows: usize,
}

impl Times {
    /// Mean period so far: more exact than the difference of two printed times.
    fn period(&self) -> f64 {
        (self.latest - self.first) / (self.rows.max(2) - 1) as f64
    }

    fn add(&mut self, row: &Row<'_>, column: usize) -> Result<(), RecordError> {
        let value = row.number(column, "time", "a finite number of seconds", f64::is_finite)?;
        match self.rows {
            0 => self.first = value,
            1 if value <= self.first => {
                return Err(row.bad(column, "time", &format!("later than {} s", self.first)));
            }
            1 => {}
            _ => {
                let due = self.latest + self.period();
                if (value - due).abs() > JITTER * self.period() {
                    let bound = format!("{due:.9} s, one period after the row before");
                    return Err(row.bad(column, "time", &bound));
                }
            }
        }
        self.latest = value;
        self.rows += 1;
        Ok(())
    }
}

struct Row<'a> {
    file: &'a str,
    line: u64,
    fields: &'a csv::StringRecord,
}

impl Row<'_> {
    fn number(
        &self,
        column: usize,
        name: &'static str,
        bound: &str,
        admits: impl Fn(f64) -> bool,
    ) -> Result<f64, RecordError> {
        let value = self.fields.get(column).unwrap_or_default().parse().ok();
        value.filter(|&value| admits(value)).ok_or_else(|| self.bad(column, name, bound))
    }

    fn bad(&self, column: usize, name: &'static str, bound: &str) -> RecordError {
        RecordError::BadField {
            file: self.file.to_owned(),
            line: self.line,
            column: column + 1,
            name,
            value: excerpt(self.fields.get(column).unwrap_or_default()),
            bound: bound.to_owned(),
        }
    }
}

fn find(header: &csv::StringRecord, names: &[&str]) -> Option<usize> {
    header.iter().position(|name| names.contains(&name.to_ascii_lowercase().as_str()))
}

fn no_column(file: &str, wanted: &'static str, header: &csv::StringRecord) -> RecordError {
    let columns = excerpt(&header.iter().map(excerpt).collect::<Vec<_>>().join(", "));
    RecordError::NoColumn { file: file.to_owned(), wanted, columns }
}

fn bad_row(file: &str, line: u64, error: &csv::Error) -> RecordError {
    let line = error.position().map_or(line, csv::Position::line);
    let message = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} fields; the header has {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
        _ => excerpt(&error.to_string()),
    };
    RecordError::BadRow { file: file.to_owned(), line, message }
}
