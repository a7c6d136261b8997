//! Runs in CSV files, as `haptic run --csv` and `haptic simulate --csv` write them.

use std::path::Path;

use thiserror::Error;

use crate::chart::trace::{Clock, Trace};
use crate::file::excerpt;
use crate::replay::row_message;
use crate::simulation::served::Served;

/// Why a recorded run cannot be read. Lines are counted from 1, the header being the first.
#[derive(Debug, Error)]
pub enum RecordedError {
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
        /// The names that it could have.
        wanted: String,
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
    #[error("{file}:{line}: column `{column}`: `{value}` must be {bound}")]
    BadValue {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The column.
        column: String,
        /// What stands there.
        value: String,
        /// What may stand there.
        bound: String,
    },
    /// A period was given for samples that have times of their own.
    #[error("{file}: its times are in seconds; a period is for runs that are counted in ticks")]
    PeriodKnown {
        /// The file.
        file: String,
    },
}

/// Whether a file is a recorded run by its name.
pub fn is_recorded(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// Reads a run: `tick` or `time` (s), `angle` or `position` (rad), `torque` (N m) and, where there
/// is one, `limit`; other columns are passed over. `period` (s) turns ticks into seconds.
///
/// # Errors
/// Where the file cannot be read, lacks a column, has a bad row, or has times beside a `period`.
pub fn load(path: &Path, period: Option<f64>) -> Result<Trace, RecordedError> {
    let file = path.display().to_string();
    let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    match csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path) {
        Ok(mut reader) => Ok(Trace { title, ..read(&file, &mut reader, period)? }),
        Err(source) => Err(RecordedError::Unreadable { file, source }),
    }
}

fn read<R: std::io::Read>(
    file: &str,
    reader: &mut csv::Reader<R>,
    period: Option<f64>,
) -> Result<Trace, RecordedError> {
    let bad_row = |line: u64, error: &csv::Error| RecordedError::BadRow {
        file: file.to_owned(),
        line: error.position().map_or(line, csv::Position::line),
        message: row_message(error),
    };
    let header = reader.headers().map_err(|error| bad_row(1, &error))?.clone();
    let layout = Layout::of(file, &header)?;
    let seconds = match (layout.clock, period) {
        (Clock::Seconds, Some(_)) => {
            return Err(RecordedError::PeriodKnown { file: file.to_owned() });
        }
        (_, period) => period.unwrap_or(1.0),
    };
    let clock = if period.is_some() { Clock::Seconds } else { layout.clock };
    let mut trace = Trace { clock, ..Trace::default() };
    let mut fields = csv::StringRecord::new();
    loop {
        let line = reader.position().line();
        match reader.read_record(&mut fields) {
            Ok(false) => return Ok(trace),
            Ok(true) => {}
            Err(error) => return Err(bad_row(line, &error)),
        }
        let line = fields.position().map_or(line, csv::Position::line);
        let row = Row { file, line, header: &header, fields: &fields };
        let time = seconds * row.number(layout.time)?;
        if trace.time.last().is_some_and(|last| time <= *last) {
            return Err(row.bad(layout.time, "more than in the row before"));
        }
        trace.time.push(time);
        trace.position.push(row.number(layout.angle)?);
        trace.torque.push(row.number(layout.torque)?);
        trace.limit.push(layout.limit.map_or(Ok(Served::IN_FULL), |column| row.served(column))?);
    }
}

/// Which columns hold what.
struct Layout {
    clock: Clock,
    time: usize,
    angle: usize,
    torque: usize,
    limit: Option<usize>,
}

impl Layout {
    fn of(file: &str, header: &csv::StringRecord) -> Result<Self, RecordedError> {
        let column = |name: &str| header.iter().position(|is| is == name);
        let one_of = |names: &[&str]| {
            names.iter().find_map(|name| column(name)).ok_or_else(|| RecordedError::NoColumn {
                file: file.to_owned(),
                wanted: names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(" or "),
                columns: excerpt(&header.iter().map(excerpt).collect::<Vec<_>>().join(", ")),
            })
        };
        let time = one_of(&["time", "tick"])?;
        Ok(Self {
            clock: if header.get(time) == Some("time") { Clock::Seconds } else { Clock::Ticks },
            time,
            angle: one_of(&["angle", "position"])?,
            torque: one_of(&["torque"])?,
            limit: column("limit"),
        })
    }
}

/// A row, with its place for messages.
struct Row<'r> {
    file: &'r str,
    line: u64,
    header: &'r csv::StringRecord,
    fields: &'r csv::StringRecord,
}

impl Row<'_> {
    fn field(&self, column: usize) -> &str {
        self.fields.get(column).unwrap_or_default()
    }

    fn number(&self, column: usize) -> Result<f64, RecordedError> {
        let value = self.field(column).parse().ok().filter(|value: &f64| value.is_finite());
        value.ok_or_else(|| self.bad(column, "a finite number"))
    }

    fn served(&self, column: usize) -> Result<Served, RecordedError> {
        Served::parse(self.field(column)).ok_or_else(|| {
            let words: Vec<_> = Served::all().map(Served::as_str).collect();
            self.bad(column, &format!("one of {}", words.join(", ")))
        })
    }

    fn bad(&self, column: usize, bound: &str) -> RecordedError {
        RecordedError::BadValue {
            file: self.file.to_owned(),
            line: self.line,
            column: excerpt(self.header.get(column).unwrap_or_default()),
            value: excerpt(self.field(column)),
            bound: bound.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use firmware::torque::LimitReason;

    use super::*;

    fn trace(text: &str, period: Option<f64>) -> Result<Trace, String> {
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        read("x.csv", &mut reader, period).map_err(|error| error.to_string())
    }

    #[test]
    fn runs_and_simulations_are_read() {
        let run = "tick,count,angle,torque,code,limit\n0,1,0.5,-1,7,none\n1,2,0.6,2,8,converter\n";
        let found = trace(run, None).unwrap();
        assert_eq!((found.clock, &found.time[..]), (Clock::Ticks, &[0.0, 1.0][..]));
        assert_eq!((&found.position[..], &found.torque[..]), (&[0.5, 0.6][..], &[-1.0, 2.0][..]));
        assert_eq!(found.limit, [Served::IN_FULL, Served::Ran(LimitReason::Converter)]);
        let found = trace(run, Some(0.25)).unwrap();
        assert_eq!((found.clock, &found.time[..]), (Clock::Seconds, &[0.0, 0.25][..]));

        let simulated = "time,position,velocity,torque,limit\n0,1,2,3,missed\n0.5,1,2,3,none\n";
        let found = trace(simulated, None).unwrap();
        assert_eq!((found.clock, found.limit[0]), (Clock::Seconds, Served::Missed));
        assert!(trace(simulated, Some(0.25)).unwrap_err().contains("times are in seconds"));
    }

    #[test]
    fn errors_name_line_column_and_value() {
        let bad =
            |rows: &str| trace(&format!("tick,angle,torque,limit\n{rows}"), None).unwrap_err();
        assert_eq!(
            bad("0,0,0,none\n1,x,0,none\n"),
            "x.csv:3: column `angle`: `x` must be a finite number"
        );
        assert!(bad("0,0,inf,none\n").contains("column `torque`: `inf`"));
        assert!(
            bad("3,0,0,none\n3,0,0,none\n").contains("x.csv:3: column `tick`: `3` must be more")
        );
        assert!(bad("0,0,0,slewed\n").ends_with("angle, not-a-number, ramp, missed"));
        assert!(bad("0,0,0\n").starts_with("x.csv:2: 3 fields"));
        let headless = trace("tick,angle\n", None).unwrap_err();
        assert_eq!(headless, "x.csv:1: there is no column `torque`; the columns are tick, angle");
    }
}
