//! Recorded encoder counts, one a tick.

use std::io::Read;
use std::path::Path;

use crate::identify::record::{SECONDS, WHOLE};
use crate::table::{Column, FoundColumn, Row, Table, TableError};
use crate::tick_gaps::TickGaps;

const COUNT: Column =
    Column { names: &["count", "counts"], bound: "a whole number from -2147483648 to 2147483647" };

const TICK: Column = Column { names: &["tick", "ticks"], bound: "a whole number, 0 or more" };
const TIME: Column = Column { names: &["time"], bound: "a finite number of seconds" };

/// Recorded counts, and the ticks that are missing between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    pub counts: Vec<i32>,
    /// Missing ticks; `None` where the file has neither ticks nor times.
    pub gaps: Option<TickGaps>,
}

/// Reads the column `count` of a CSV file with a header, and `tick` or `time` (s), which state the ticks that
/// are missing; other columns are passed over. `period` in s is that of a tick.
///
/// # Errors
/// Where the file cannot be read, has no such column or no row, or has a field that is not a count.
pub fn load(path: &Path, period: f64) -> Result<Recording, TableError> {
    read(Table::open(path)?, period)
}

fn read<R: Read>(mut table: Table<R>, period: f64) -> Result<Recording, TableError> {
    let column = table.column_in(COUNT, WHOLE)?;
    let clock = match table.find(TICK) {
        Some(tick) => Some(Clock::Ticks(tick)),
        None => table.find_in(TIME, SECONDS)?.map(|column| Clock::Seconds { column, first: None }),
    };
    let (mut counts, mut gaps, mut clock) = (Vec::new(), TickGaps::default(), clock);
    while let Some(row) = table.row()? {
        counts.push(row.number(column, |_| true)?);
        if let Some(clock) = &mut clock {
            gaps.add(clock.tick(&row, period)?, 1);
        }
    }
    table.at_least(1)?;
    Ok(Recording { counts, gaps: clock.map(|_| gaps) })
}

/// The column that numbers the ticks.
enum Clock {
    Ticks(FoundColumn),
    Seconds { column: FoundColumn, first: Option<f64> },
}

impl Clock {
    fn tick(&mut self, row: &Row<'_>, period: f64) -> Result<u64, TableError> {
        match self {
            Self::Ticks(column) => row.number(*column, |_| true),
            Self::Seconds { column, first } => {
                let time = row.in_si(*column, |time| time.is_finite())?;
                let first = *first.get_or_insert(time);
                // A time before the first is a restart, as a tick before the last is.
                Ok(((time - first) / period).round().max(0.0) as u64)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<Vec<i32>, String> {
        let recording = Table::new("x.csv", text).and_then(|table| super::read(table, 1e-3));
        recording.map(|recording| recording.counts).map_err(|error| error.to_string())
    }

    #[test]
    fn counts_are_found_by_name() {
        assert_eq!(read(b"time_s,count\n0.0,-3\n0.1, 7\n"), Ok(vec![-3, 7]));
        assert_eq!(read(b"\xef\xbb\xbfCOUNTS\r\n1\r\n2\r\n"), Ok(vec![1, 2]));
    }

    #[test]
    fn errors_name_line_column_and_value() {
        let bad = read(b"count\n1\n2.5\n").unwrap_err();
        assert!(bad.starts_with("x.csv:3: column 1, `count`: `2.5` is out of bounds"), "{bad}");
        let bad = read(b"count\n1\n99999999999\n").unwrap_err();
        let bounds = format!("from {} to {}", i32::MIN, i32::MAX);
        assert!(bad.contains("x.csv:3") && bad.contains(&bounds), "{bad}");
        assert!(read(b"a,b\n1,2\n").unwrap_err().contains("the columns are a, b"));
        assert!(read(b"a,count\n1,2\n1\n").unwrap_err().starts_with("x.csv:3: 1 fields"));
        assert!(read(b"count\n\xff\n").unwrap_err().starts_with("x.csv:2: not UTF-8"));
        assert!(read(b"").is_err() && read(b"count\n").is_err());
    }

    #[test]
    fn a_folder_cannot_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let message = load(folder.path(), 1e-3).unwrap_err().to_string();
        assert!(message.contains("cannot be read"), "{message}");
    }
}
