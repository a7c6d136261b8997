//! A recorded measurement: time, commanded torque and counts, one row a tick.

use std::io::Read;
use std::path::Path;

use crate::table::{Column, FoundColumn, Row, Table, TableError};

/// Largest deviation of a row's time from its tick, as a part of the period: a slip of a whole tick is found,
/// and the rounding of printed decimals is not taken for a slip.
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
    /// Frequency in Hz that the torque has at each tick, 0 where it has none; `None` where the record does
    /// not state it.
    pub frequency: Option<Vec<f64>>,
}

/// Fewest rows of a record.
pub const LEAST_ROWS: usize = 16;

const TIME: Column =
    Column { names: &["time", "time_s", "t"], bound: "a finite number of seconds" };
const TORQUE: Column = Column { names: &["torque", "torque_nm"], bound: "a finite number in N m" };
const COUNTS: Column = Column { names: &["counts", "count"], bound: "a whole number below 2^53" };
const FREQUENCY: Column =
    Column { names: &["frequency", "frequency_hz"], bound: "a finite number of Hz, 0 or more" };

/// Largest count that a double distinguishes from its neighbours.
const LARGEST_COUNT: f64 = 9_007_199_254_740_991.0;

/// Reads the columns `time` (s), `torque` (N m), `counts` and, where it is there, `frequency` (Hz) of a CSV
/// file with a header; other columns are passed over. The time must advance by the same period from row to
/// row.
///
/// # Errors
/// Where the file cannot be read, lacks a column, has fewer than [`LEAST_ROWS`] rows, or has a field that is
/// invalid in its column.
pub fn load(path: &Path) -> Result<Record, TableError> {
    read(Table::open(path)?)
}

/// The same from anything that can be read; messages call it `file`.
///
/// # Errors
/// As [`load`].
pub fn parse(file: &str, text: impl Read) -> Result<Record, TableError> {
    read(Table::new(file, text)?)
}

fn read<R: Read>(mut table: Table<R>) -> Result<Record, TableError> {
    let time = table.column(TIME)?;
    let torque = table.column(TORQUE)?;
    let counts = table.column(COUNTS)?;
    let frequency = table.find(FREQUENCY);
    let mut times = Times::default();
    let mut record = Record {
        period: 0.0,
        torque: vec![],
        counts: vec![],
        frequency: frequency.map(|_| vec![]),
    };
    while let Some(row) = table.row()? {
        times.add(&row, time)?;
        record.torque.push(row.number(torque, |torque: &f64| torque.is_finite())?);
        let is_count = |count: &f64| count.fract() == 0.0 && count.abs() <= LARGEST_COUNT;
        record.counts.push(row.number(counts, is_count)?);
        if let (Some(column), Some(values)) = (frequency, &mut record.frequency) {
            values.push(row.number(column, |hertz: &f64| hertz.is_finite() && *hertz >= 0.0)?);
        }
    }
    table.at_least(LEAST_ROWS)?;
    record.period = times.period();
    Ok(record)
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

    fn add(&mut self, row: &Row<'_>, column: FoundColumn) -> Result<(), TableError> {
        let value = row.number(column, |time: &f64| time.is_finite())?;
        match self.rows {
            0 => self.first = value,
            1 if value <= self.first => {
                return Err(row.bad(column, &format!("later than {} s", self.first)));
            }
            1 => {}
            _ => {
                let due = self.latest + self.period();
                if (value - due).abs() > JITTER * self.period() {
                    let bound = format!("{due:.9} s, one period after the row before");
                    return Err(row.bad(column, &bound));
                }
            }
        }
        self.latest = value;
        self.rows += 1;
        Ok(())
    }
}
