//! `haptic identify --reference-per-rev`: the nonlinearity of an encoder, its age and its hysteresis, by a second
//! encoder on the same shaft.

use std::f64::consts::TAU;
use std::io;
use std::path::Path;

use haptic_servo::magnetic::Chip;
use haptic_servo::scene::TimeRange;
use serde::Serialize;

use super::device_file::{Number, with_numbers};
use super::turns::not_resolved;
use super::{Arguments, age};
use crate::command::shared_arguments::write;
use crate::command::status::{CommandError, CommandStatus};
use crate::identify::turns::{Floor, Harmonic};
use crate::identify::{self, CONFIDENCE, Estimate, IdentifyError, Linearity, record};
use crate::quantity::significant;
use crate::table::Table;

#[derive(Serialize)]
struct Report<'a> {
    /// Largest slope of the error over the angle.
    linearity: Estimate,
    /// Largest error in rad.
    error: Estimate,
    harmonics: &'a [Harmonic],
    /// Amplitudes in rad that would not have been found.
    not_resolved: &'a [Floor],
    /// In s; `None` where all turns have nearly one speed.
    age: Option<Estimate>,
    /// In counts.
    hysteresis: Estimate,
    turns: usize,
    confidence: f64,
}

/// Prints the nonlinearity that the two columns of counts show, and writes it to a file of the device.
pub fn run(
    arguments: &Arguments,
    path: &Path,
    counts_per_turn: f64,
    reference: f64,
) -> Result<CommandStatus, CommandError> {
    let pair = match path == Path::new("-") {
        true => {
            record::pair(Table::new("<stdin>", io::stdin().lock()).map_err(IdentifyError::from)?)
        }
        false => record::pair(Table::open(path).map_err(IdentifyError::from)?),
    };
    let pair = pair.map_err(IdentifyError::from)?;
    let found = identify::linearity(&pair, [counts_per_turn, reference])?;
    let written = arguments.output.as_deref().map(age::chip_and_age);
    let (chip, stated) = written.transpose()?.unwrap_or_default();
    let numbers = numbers(&found, (chip, stated), counts_per_turn)?;
    if let Some(path) = &arguments.output {
        write(path, &with_numbers(path, &numbers, counts_per_turn)?)?;
    }
    let counts = |angle: f64| angle * counts_per_turn / TAU;
    let Estimate { value, lo, hi } = found.hysteresis;
    let report = Report {
        linearity: found.slope,
        error: found.error,
        harmonics: &found.harmonics,
        not_resolved: &found.floors,
        age: found.age,
        hysteresis: Estimate { value: counts(value), lo: counts(lo), hi: counts(hi) },
        turns: found.turns,
        confidence: CONFIDENCE,
    };
    arguments.answer.print(&report, |report| text(&found, report, stated, &numbers))?;
    Ok(CommandStatus::Success)
}

/// The numbers of the device's file.
///
/// # Errors
/// If some angles are read twice: the slope of the error, which a file bounds by 1, is as large as that of the angle.
fn numbers(
    found: &Linearity,
    (chip, stated): (Option<&Chip>, Option<TimeRange>),
    counts_per_turn: f64,
) -> Result<Vec<Number>, CommandError> {
    let slope = found.slope.hi * (1.0 + 5e-3);
    if slope >= 1.0 {
        let slope = significant(slope, 3);
        let error = format!(
            "the slope of the error, `encoder.linearity`, is up to {slope} and has to be less than 1: the encoder reads \
             some angles twice. Check the counts per turn of both encoders, and the place of the magnet"
        );
        return Err(CommandError::Failed(error.into()));
    }
    let linearity = Number {
        table: "encoder",
        key: "linearity",
        // Rounded up.
        value: significant(slope, 3),
        comment: "largest slope of the error, at 95 %".into(),
    };
    // The age of a chip is that of all of its kind. What a file states may have a delay of the torque in it.
    let age = found.age.filter(|age| chip.is_none() && age.hi > 0.0).map(|age| {
        let most = stated.map_or(age.hi, |stated| stated.most.max(age.hi));
        let comment = match most > age.hi {
            true => "at 95 %, up to the most that the file stated",
            false => "at 95 %",
        };
        age::number(TimeRange::between(age.lo.max(0.0), most), comment)
    });
    // At one speed an age looks like it.
    let hysteresis = found.age.map(|_| Number {
        table: "encoder",
        key: "hysteresis",
        value: significant(found.hysteresis.hi.max(0.0) * counts_per_turn / TAU * (1.0 + 5e-3), 3),
        comment: "counts, at 95 %".into(),
    });
    Ok([Some(linearity), hysteresis, age].into_iter().flatten().collect())
}

fn text(
    found: &Linearity,
    report: &Report<'_>,
    stated: Option<TimeRange>,
    numbers: &[Number],
) -> String {
    let of = |e: &Estimate| {
        let reach = significant((e.value - e.lo).max(e.hi - e.value), 2);
        format!("{} +- {reach}", significant(e.value, 3))
    };
    let harmonics = found
        .harmonics
        .iter()
        .take(3)
        .map(|harmonic| format!("{}: {}", harmonic.count, of(&harmonic.amplitude)));
    let harmonics: Vec<String> = harmonics.collect();
    let age = match &found.age {
        None => {
            "not told from hysteresis: the turns have nearly one speed. Record others, too, and no file gets the \
             hysteresis that this one may be"
                .to_owned()
        }
        Some(age) => age::compared(age, stated),
    };
    let rows = [
        (
            "linearity",
            format!(
                "{} at most, by the slope at {}",
                significant(found.slope.hi, 3),
                of(&found.slope)
            ),
        ),
        ("error", format!("{} rad at most", of(&found.error))),
        ("harmonics", format!("rad by harmonic: {}", harmonics.join(", "))),
        ("not resolved", not_resolved(&found.floors, "rad")),
        ("age", age),
        ("hysteresis", format!("{} counts", of(&report.hysteresis))),
        ("turns", found.turns.to_string()),
    ];
    let rows: String = rows.iter().map(|(label, value)| format!("{label:<12} {value}\n")).collect();
    let in_file = numbers.iter().map(|Number { table, key, value, comment }| {
        format!("{table}.{key} = {value} # {comment}\n")
    });
    format!("{rows}\n{}", in_file.collect::<String>())
}
