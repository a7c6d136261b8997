//! Ticks as a table that other programs read.

use std::io::{self, BufWriter, Write};
use std::num::NonZeroU32;

use super::sample::{COLUMNS, Row, Sample};
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

    /// Adds a tick.
    pub fn add(&mut self, sample: &Sample) -> io::Result<()> {
        if self.count == 0 {
            writeln!(self.rows, "{COLUMNS}")?;
        }
        self.count += 1;
        self.gaps.add(sample.tick, self.every);
        writeln!(self.rows, "{}", Row::from(sample))
    }

    /// Writes everything that was added.
    pub fn flush(&mut self) -> io::Result<()> {
        self.rows.flush()
    }

    /// Ticks that are missing between those that were added.
    pub fn gaps(&self) -> &TickGaps {
        &self.gaps
    }

    /// Ticks that were added.
    pub fn count(&self) -> u64 {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::dac::DacCode;
    use haptic_servo::servo_loop::{Frame, State};
    use haptic_servo::torque::LimitReason;
    use haptic_servo::wire::message::BoardUnits;

    use super::super::sample::Scale;
    use super::*;

    /// The rows equal those of a CSV library, byte for byte.
    #[test]
    fn rows_are_those_of_the_library_for_csv() {
        let board = BoardUnits {
            period: 0.001,
            timer_counts: 170_000,
            counts_per_turn: 4000.0,
            full_scale_torque: 1.791,
            energy_step: 1e-6,
            longest_gap: 0.036,
        };
        let mut scale = Scale::new(board);
        let (limit, state) = (LimitReason::Torque, State::Running);
        let mut library = csv::Writer::from_writer(Vec::new());
        let mut rows = format!("{COLUMNS}\n");
        for (i, code) in [0, 2047, 2048, 2049, 4095].into_iter().enumerate() {
            let code = DacCode::new(code).unwrap();
            let frame = Frame {
                tick: 3 * i as u32,
                count: 1 - i as i32,
                code,
                limit,
                state,
                slack: 7 * i as u32,
            };
            let row = Row::from(&scale.sample(&frame));
            library.serialize(&row).unwrap();
            rows += &format!("{row}\n");
        }
        assert_eq!(rows, String::from_utf8(library.into_inner().unwrap()).unwrap());
    }
}
