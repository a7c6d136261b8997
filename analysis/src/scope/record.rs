//! Ticks as a table that other programs read.

use std::io::{self, Write};

use super::sample::{Row, Sample};

/// Writes ticks as CSV: tick, time, count, position, code, torque, state, limit, slack; in s, rad
/// and N m.
pub struct Recorder {
    rows: csv::Writer<Box<dyn Write>>,
    count: u64,
}

impl Recorder {
    /// Writes there.
    pub fn new(to: Box<dyn Write>) -> Self {
        Self { rows: csv::Writer::from_writer(to), count: 0 }
    }

    /// Adds a tick.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn add(&mut self, sample: &Sample) -> io::Result<()> {
        self.count += 1;
        self.rows.serialize(Row::from(sample)).map_err(|error| match error.into_kind() {
            csv::ErrorKind::Io(error) => error,
            other => io::Error::other(format!("{other:?}")),
        })
    }

    /// Has everything written that was added.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.rows.flush()
    }

    /// Ticks that were added.
    pub fn count(&self) -> u64 {
        self.count
    }
}
