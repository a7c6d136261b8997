//! A recorded measurement: time, commanded torque and counts, one row a tick.

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use crate::quantity::significant;
use crate::table::{Column, FoundColumn, Row, Table, TableError, Unit};

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

const TIME: Column = Column { names: &["time", "t"], bound: "a finite number of seconds" };
const TORQUE: Column = Column { names: &["torque"], bound: "a finite number in N m" };
const COUNTS: Column = Column { names: &["counts", "count"], bound: "a whole number below 2^53" };
const REFERENCE: Column =
    Column { names: &["reference"], bound: "a whole number of counts below 2^53" };
const ANGLE: Column = Column { names: &["angle", "position"], bound: "a finite angle" };
const FREQUENCY: Column =
    Column { names: &["frequency"], bound: "a finite number of Hz, 0 or more" };

/// Units of time.
pub const SECONDS: &[Unit] = &[
    Unit { names: &["s", "sec", "seconds"], factor: 1.0 },
    Unit { names: &["ms"], factor: 1e-3 },
    Unit { names: &["us", "\u{b5}s", "\u{3bc}s"], factor: 1e-6 },
];
const NEWTON_METRES: &[Unit] = &[
    Unit { names: &["N m", "Nm", "N*m", "N.m", "nm"], factor: 1.0 },
    Unit { names: &["mN m", "mNm", "mN*m", "mN.m", "mnm"], factor: 1e-3 },
    Unit { names: &["N cm", "Ncm"], factor: 1e-2 },
];
/// Units of counts.
pub const WHOLE: &[Unit] = &[Unit { names: &["counts", "count", "1"], factor: 1.0 }];
const RADIANS: &[Unit] = &[
    Unit { names: &["rad"], factor: 1.0 },
    Unit { names: &["mrad"], factor: 1e-3 },
    Unit { names: &["deg", "degrees", "\u{b0}"], factor: TAU / 360.0 },
    Unit { names: &["turns", "rev"], factor: TAU },
];
const HERTZ: &[Unit] = &[
    Unit { names: &["Hz", "hz"], factor: 1.0 },
    Unit { names: &["kHz"], factor: 1e3 },
    Unit { names: &["rad/s"], factor: 1.0 / TAU },
];

/// Largest count that a double distinguishes from its neighbours.
const LARGEST_COUNT: f64 = 9_007_199_254_740_991.0;

/// Reads the columns `time`, `torque`, `counts` or `angle`, and, where it is there, `frequency` of a CSV file
/// with a header; other columns are passed over. A column may state its unit, as `torque (mNm)`; without one
/// it is in s, N m and Hz, and an angle must state it. Angles become counts of `count_angle` rad. The time must
/// advance by the same period from row to row.
///
/// # Errors
/// Where the file cannot be read, lacks a column, has fewer than [`LEAST_ROWS`] rows, or has a field that is
/// invalid in its column.
pub fn load(path: &Path, count_angle: f64) -> Result<Record, TableError> {
    read(Table::open(path)?, count_angle)
}

/// The same from anything that can be read; messages call it `file`.
pub fn parse(file: &str, text: impl Read, count_angle: f64) -> Result<Record, TableError> {
    read(Table::new(file, text)?, count_angle)
}

/// Writes a record row by row, so that its file has the rows before an end that came too early.
#[derive(Debug, Default)]
pub struct Recorder<'a> {
    path: Option<&'a Path>,
    file: Option<File>,
    failure: Option<TableError>,
}

impl<'a> Recorder<'a> {
    /// One for this file, which stays as it is until the record begins; without a path for none.
    pub fn new(path: Option<&'a Path>) -> Self {
        Self { path, ..Self::default() }
    }

    /// Begins the record, once more if it had begun, with the names of its columns.
    pub fn begin(&mut self, heading: &str) {
        let Some(path) = self.path else { return };
        match File::create(path) {
            Ok(file) => self.file = Some(file),
            Err(error) => self.failure = Some(unwritable(path, &error)),
        }
        self.row(heading);
    }

    /// Adds a row.
    pub fn row(&mut self, row: &str) {
        let (Some(path), Some(file), None) = (self.path, &mut self.file, &self.failure) else {
            return;
        };
        // A whole row at once, without a buffer that Ctrl-C would lose.
        let written = file.write_all(format!("{row}\n").as_bytes());
        self.failure = written.err().map(|error| unwritable(path, &error));
    }

    /// Ends the record.
    ///
    /// # Errors
    /// Where a row could not be written.
    pub fn end(self) -> Result<(), TableError> {
        self.failure.map_or(Ok(()), Err)
    }
}

fn unwritable(path: &Path, error: &io::Error) -> TableError {
    TableError::of_file(&path.display().to_string(), format!("cannot be written: {error}"))
}

/// The column of the motion, in counts or as an angle.
enum Motion {
    Counts(FoundColumn),
    Angle(FoundColumn),
}

impl Motion {
    fn find<R: Read>(table: &Table<R>) -> Result<Self, TableError> {
        if let Some(counts) = table.find_in(COUNTS, WHOLE)? {
            return Ok(Self::Counts(counts));
        }
        match table.find_in(ANGLE, RADIANS)? {
            Some(angle) if angle.has_unit => Ok(Self::Angle(angle)),
            Some(FoundColumn { name, .. }) => {
                let message = format!(
                    "the column `{name}` has no unit: name it `{name} (rad)` or `{name} (deg)`"
                );
                Err(TableError::in_line(table.file(), 1, message))
            }
            None => Err(table.missing(COUNTS)),
        }
    }

    fn counts(&self, row: &Row<'_>, count_angle: f64) -> Result<f64, TableError> {
        match *self {
            Self::Counts(column) => row
                .number(column, |count: &f64| count.fract() == 0.0 && count.abs() <= LARGEST_COUNT),
            Self::Angle(column) => Ok(row.in_si(column, |angle| angle.is_finite())? / count_angle),
        }
    }
}

fn read<R: Read>(mut table: Table<R>, count_angle: f64) -> Result<Record, TableError> {
    let time = table.column_in(TIME, SECONDS)?;
    let torque = table.column_in(TORQUE, NEWTON_METRES)?;
    let motion = Motion::find(&table)?;
    let frequency = table.find_in(FREQUENCY, HERTZ)?;
    let mut times = Times::default();
    let mut record = Record {
        period: 0.0,
        torque: vec![],
        counts: vec![],
        frequency: frequency.map(|_| vec![]),
    };
    while let Some(row) = table.row()? {
        times.add(&row, time)?;
        record.torque.push(row.in_si(torque, |torque| torque.is_finite())?);
        record.counts.push(motion.counts(&row, count_angle)?);
        if let (Some(column), Some(values)) = (frequency, &mut record.frequency) {
            values.push(row.in_si(column, |hertz| hertz.is_finite() && *hertz >= 0.0)?);
        }
    }
    times.check_gaps(table.file())?;
    table.at_least(LEAST_ROWS)?;
    record.period = times.period();
    Ok(record)
}

/// Counts of two encoders on one shaft, over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Sampling period in s.
    pub period: f64,
    /// Counts of the encoder that is measured.
    pub counts: Vec<f64>,
    /// Counts of the encoder that it is compared with.
    pub reference: Vec<f64>,
}

/// Reads the columns `time`, `counts` and `reference` in the same way.
///
/// # Errors
/// As [`load`].
pub fn pair<R: Read>(mut table: Table<R>) -> Result<Pair, TableError> {
    let time = table.column_in(TIME, SECONDS)?;
    let [counts, reference] = [table.column_in(COUNTS, WHOLE)?, table.column_in(REFERENCE, WHOLE)?];
    let whole = |count: &f64| count.fract() == 0.0 && count.abs() <= LARGEST_COUNT;
    let mut times = Times::default();
    let mut pair = Pair { period: 0.0, counts: vec![], reference: vec![] };
    while let Some(row) = table.row()? {
        times.add(&row, time)?;
        pair.counts.push(row.number(counts, whole)?);
        pair.reference.push(row.number(reference, whole)?);
    }
    times.check_gaps(table.file())?;
    table.at_least(LEAST_ROWS)?;
    pair.period = times.period();
    Ok(pair)
}

/// The times so far, which must be those of evenly spaced ticks.
#[derive(Default)]
struct Times {
    first: f64,
    latest: f64,
    /// Periods from the first time to the latest.
    periods: usize,
    rows: usize,
    gaps: Gaps,
}

/// Places at which rows are missing.
#[derive(Default)]
struct Gaps {
    count: usize,
    missing: usize,
    /// The line behind the first, and the times before and behind it.
    first: Option<(u64, f64, f64)>,
}

/// Largest number of periods that a gap may have; more is another clock.
const LONGEST_GAP: f64 = 1e9;

impl Times {
    /// Mean period so far: more exact than the difference of two printed times.
    fn period(&self) -> f64 {
        (self.latest - self.first) / self.periods.max(1) as f64
    }

    fn add(&mut self, row: &Row<'_>, column: FoundColumn) -> Result<(), TableError> {
        let value = row.in_si(column, |time| time.is_finite())?;
        let mut periods = 1;
        match self.rows {
            0 => (self.first, periods) = (value, 0),
            1 if value <= self.first => {
                return Err(row.bad(column, &format!("later than {} s", self.first)));
            }
            1 => {}
            _ => {
                let passed = (value - self.latest) / self.period();
                let whole = passed.round();
                if !(1.0..LONGEST_GAP).contains(&whole) || (passed - whole).abs() > JITTER {
                    let due = significant(self.latest + self.period(), 9);
                    let bound = format!("{due} s, one period after the row before");
                    return Err(row.bad(column, &bound));
                }
                periods = whole as usize;
                if periods > 1 {
                    self.gaps.count += 1;
                    self.gaps.missing += periods - 1;
                    self.gaps.first.get_or_insert((row.line(), self.latest, value));
                }
            }
        }
        self.latest = value;
        self.periods += periods;
        self.rows += 1;
        Ok(())
    }

    /// Refuses rows that are missing: all of them at once, with the first.
    fn check_gaps(&self, file: &str) -> Result<(), TableError> {
        let Gaps { count, missing, first: Some((line, before, behind)) } = self.gaps else {
            return Ok(());
        };
        let [before, behind, period] =
            [before, behind, self.period()].map(|time| significant(time, 9));
        let message = format!(
            "the time goes from {before} s to {behind} s, by more than one period of {period} s: rows are missing \
             ({missing} rows in {count} gaps in the file). Record again without gaps, or cut the file there"
        );
        Err(TableError::in_line(file, line, message))
    }
}
