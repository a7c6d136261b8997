//! Ticks as a table that other programs read.

use std::io::{self, BufWriter, Write};
use std::num::NonZeroU32;

use super::sample::{COLUMNS, Sample};
use crate::tick_gaps::TickGaps;

/// Writes ticks as CSV: tick, time, count, position, code, torque, state, limit, slack; in s, rad
/// and N m.
pub struct Recorder {
    rows: BufWriter<Box<dyn Write>>,
    count: u64,
    every: u64,
    gaps: TickGaps,
}

impl Recorder {
    /// Writes every `every`th tick to this stream.
    pub fn new(to: Box<dyn Write>, every: NonZeroU32) -> Self {
        let (rows, every) = (BufWriter::new(to), u64::from(every.get()));
        Self { rows, count: 0, every, gaps: TickGaps::default() }
    }

    pub fn add(&mut self, sample: &Sample) -> io::Result<()> {
        if self.count == 0 {
            writeln!(self.rows, "{COLUMNS}")?;
        }
        self.count += 1;
        self.gaps.add(sample.tick, self.every);
        writeln!(self.rows, "{sample}")
    }

    pub fn flush(&mut self) -> io::Result<()> {
        self.rows.flush()
    }

    /// Ticks that are missing between those that were added.
    pub fn gaps(&self) -> &TickGaps {
        &self.gaps
    }

    pub fn count(&self) -> u64 {
        self.count
    }
}
