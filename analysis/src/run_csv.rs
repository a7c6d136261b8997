//! Runs in CSV files, as `haptic run --csv` and `haptic simulate --csv` write them.

use std::io::Read;
use std::path::Path;

use thiserror::Error;

use crate::simulation::tick_status::TickStatus;
use crate::table::{Column, FoundColumn, Row, Table, TableError};
use crate::trace::{TimeUnit, Trace};

/// Why a recorded run cannot be read.
#[derive(Debug, Error)]
pub enum RunCsvError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{file} has times in seconds; --period is only for a file with tick numbers")]
    PeriodKnown { file: String },
}

const FINITE: &str = "a finite number";
/// In seconds by its first name, in ticks by its second.
const TIME: Column = Column { names: &[SECONDS, "tick"], bound: FINITE };
const SECONDS: &str = "time";
const ANGLE: Column = Column { names: &["angle", "position"], bound: FINITE };
const VELOCITY: Column = Column { names: &["velocity"], bound: FINITE };
const HAND: Column = Column { names: &["hand"], bound: "a finite number, or nothing" };
const TORQUE: Column = Column { names: &["torque"], bound: FINITE };
const LIMIT: Column = Column { names: &["limit"], bound: "a reason" };

/// Whether a file is a recorded run by its name.
pub fn is_run_csv(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// Reads a run: `tick` or `time` (s), `angle` or `position` (rad), `torque` (N m) and, if present, `velocity`
/// (rad/s, where the times are in s), `hand` (N m) and `limit`; other columns are passed over. `period` (s)
/// turns ticks into seconds.
///
/// # Errors
/// Where the file cannot be read, lacks a column, has a bad row, or has times beside a `period`.
pub fn load(path: &Path, period: Option<f64>) -> Result<Trace, RunCsvError> {
    let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Trace { title, ..read(Table::open(path)?, period)? })
}

fn read<R: Read>(mut table: Table<R>, period: Option<f64>) -> Result<Trace, RunCsvError> {
    let time = table.column(TIME)?;
    let (angle, torque) = (table.column(ANGLE)?, table.column(TORQUE)?);
    let (limit, hand) = (table.find(LIMIT), table.find(HAND));
    let own = if time.name == SECONDS { TimeUnit::Seconds } else { TimeUnit::Ticks };
    if own == TimeUnit::Seconds && period.is_some() {
        return Err(RunCsvError::PeriodKnown { file: table.file().to_owned() });
    }
    let time_unit = if period.is_some() { TimeUnit::Seconds } else { own };
    // A velocity in rad/s belongs to times in s.
    let velocity = table.find(VELOCITY).filter(|_| time_unit == TimeUnit::Seconds);
    let mut trace = Trace { time_unit, ..Trace::default() };
    let finite = |value: &f64| value.is_finite();
    while let Some(row) = table.row()? {
        let at = period.unwrap_or(1.0) * row.number(time, finite)?;
        if trace.time.last().is_some_and(|last| at <= *last) {
            return Err(row.bad(time, "more than in the row before").into());
        }
        trace.time.push(at);
        trace.position.push(row.number(angle, finite)?);
        if let Some(velocity) = velocity {
            trace.velocity.push(row.number(velocity, finite)?);
        }
        if let Some(hand) = hand {
            let is_known = !row.text(hand).is_empty();
            trace.hand_torque.push(if is_known { row.number(hand, finite)? } else { f64::NAN });
        }
        trace.torque.push(row.number(torque, finite)?);
        trace.limit.push(limit.map_or(Ok(TickStatus::UNLIMITED), |limit| status(&row, limit))?);
    }
    if trace.hand_torque.iter().all(|torque| torque.is_nan()) {
        trace.hand_torque.clear();
    }
    Ok(trace)
}

fn status(row: &Row<'_>, limit: FoundColumn) -> Result<TickStatus, TableError> {
    TickStatus::parse(row.text(limit)).ok_or_else(|| {
        let words: Vec<_> = TickStatus::all().map(TickStatus::as_str).collect();
        row.bad(limit, &format!("one of {}", words.join(", ")))
    })
}

#[cfg(test)]
mod tests {
    use haptic_servo::torque::LimitReason;

    use super::*;

    fn trace(text: &str, period: Option<f64>) -> Result<Trace, String> {
        let table = Table::new("x.csv", text.as_bytes()).map_err(|error| error.to_string())?;
        read(table, period).map_err(|error| error.to_string())
    }

    #[test]
    fn runs_and_simulations_are_read() {
        let run = "tick,count,angle,torque,code,limit\n0,1,0.5,-1,7,none\n1,2,0.6,2,8,converter\n";
        let found = trace(run, None).unwrap();
        assert_eq!((found.time_unit, &found.time[..]), (TimeUnit::Ticks, &[0.0, 1.0][..]));
        assert_eq!((&found.position[..], &found.torque[..]), (&[0.5, 0.6][..], &[-1.0, 2.0][..]));
        assert_eq!(found.limit, [TickStatus::UNLIMITED, TickStatus::Ran(LimitReason::DacRange)]);
        let found = trace(run, Some(0.25)).unwrap();
        assert_eq!((found.time_unit, &found.time[..]), (TimeUnit::Seconds, &[0.0, 0.25][..]));

        let simulated = "time,position,velocity,torque,limit\n0,1,2,3,missed\n0.5,1,2,3,none\n";
        let found = trace(simulated, None).unwrap();
        assert_eq!((found.time_unit, found.limit[0]), (TimeUnit::Seconds, TickStatus::Missed));
    }

    #[test]
    fn times_that_stand_still_and_other_reasons_are_refused() {
        let bad =
            |rows: &str| trace(&format!("tick,angle,torque,limit\n{rows}"), None).unwrap_err();
        assert!(
            bad("3,0,0,none\n3,0,0,none\n")
                .contains("x.csv:3: column 1, `tick`: `3` is out of bounds; it must be more")
        );
        assert!(bad("0,0,0,slewed\n").ends_with("angle, not-a-number, ramp, heat, energy, missed"));
    }
}
