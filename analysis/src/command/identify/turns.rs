//! `haptic identify --turns`: friction and cogging from slow whole turns in both directions.

use std::path::Path;

use serde::Serialize;

use super::device_file::{Number, with_numbers};
use super::target::Origin;
use super::{Arguments, Measured};
use crate::command::shared_arguments::write;
use crate::command::status::{CommandError, CommandStatus};
use crate::disturbance::Sine;
use crate::file;
use crate::identify::turns::{Floor, Harmonic};
use crate::identify::{self, CONFIDENCE, Estimate, SlowTurns};
use crate::quantity::significant;

#[derive(Serialize)]
struct Report<'a> {
    inertia: Estimate,
    damping: Estimate,
    /// Mean over the turn in N m.
    friction: Estimate,
    /// Least over the turn in N m.
    least_friction: Estimate,
    /// Harmonics of the friction over the angle.
    friction_harmonics: &'a [u32],
    /// Torque in N m that is the same at all angles and in both directions.
    mean: Estimate,
    cogging: Cogging<'a>,
    /// Turns forward and back.
    turns: [usize; 2],
    /// Least and largest mean speed of a turn in rad/s.
    speeds: [f64; 2],
    confidence: f64,
    measured: Option<&'a Origin>,
}

#[derive(Serialize)]
struct Cogging<'a> {
    /// Torque in N m at equally spaced angles of a turn, from 0 on, the mean included.
    torque: &'a [f64],
    /// Half of the interval of each of these torques in N m, with all harmonics up to `highest`: what remains
    /// where the map opposes the cogging.
    uncertainty: f64,
    highest: u32,
    /// Whether the map is told from noise; otherwise no file gets it.
    told: bool,
    harmonics: &'a [Harmonic],
    /// Amplitudes in N m that would not have been found.
    not_resolved: &'a [Floor],
}

/// What the file of which numbers are replaced states.
#[derive(Default)]
struct Stated {
    linearity: f64,
    /// In N m.
    friction: f64,
    /// Whether it has a map of the cogging.
    has_map: bool,
}

impl Stated {
    fn of(path: &Path) -> Result<Self, CommandError> {
        let path = path.to_string_lossy();
        let file = file::load_device(&path)?;
        Ok(Self {
            linearity: file.reading.linearity,
            friction: file.disturbance.friction,
            has_map: file::load_json(&path)?.get("anticogging").is_some(),
        })
    }

    /// Whether its friction is more than the measured one.
    fn has_more_friction(&self, found: &SlowTurns) -> bool {
        self.friction > found.least_friction.hi
    }
}

/// Prints what the turns of a record show, and writes it to a file of the device.
pub fn run(arguments: &Arguments, measured: &Measured) -> Result<CommandStatus, CommandError> {
    let Measured { record, origin, counts_per_turn, .. } = measured;
    let correction = arguments.reading.correction(*counts_per_turn, 0.0);
    let found = identify::slow_turns(record, &correction)?;
    let stated = arguments.output.as_deref().map(Stated::of).transpose()?.unwrap_or_default();
    let numbers = numbers(&found, &stated);
    if let Some(path) = &arguments.output {
        write(path, &with_numbers(path, &numbers, *counts_per_turn)?)?;
    }
    let report = report(&found, origin.as_ref());
    arguments.answer.print(&report, |_| text(&found, &stated, origin.as_ref(), &numbers))?;
    Ok(CommandStatus::Success)
}

fn report<'a>(found: &'a SlowTurns, measured: Option<&'a Origin>) -> Report<'a> {
    Report {
        inertia: found.inertia,
        damping: found.damping,
        friction: found.friction,
        least_friction: found.least_friction,
        friction_harmonics: &found.friction_harmonics,
        mean: found.mean,
        cogging: Cogging {
            torque: &found.map,
            uncertainty: found.uncertainty,
            highest: found.highest,
            told: found.tells_cogging(),
            harmonics: &found.harmonics,
            not_resolved: &found.floors,
        },
        turns: found.turns,
        speeds: found.speeds,
        confidence: CONFIDENCE,
        measured,
    }
}

/// The numbers of the device's file.
fn numbers(found: &SlowTurns, stated: &Stated) -> Vec<Number> {
    let friction = friction(found, stated);
    if !found.tells_cogging() {
        return friction.into_iter().collect();
    }
    let torques: Vec<String> = found.map.iter().map(|torque| significant(*torque, 4)).collect();
    let map = Number {
        table: "anticogging",
        key: "torque",
        value: format!("[{}]", torques.join(", ")),
        comment: format!(
            "N m, each +- {} N m at 95 % with the harmonics up to {} a turn",
            significant(found.uncertainty, 2),
            found.highest
        ),
    };
    let comment = String::new();
    let share = Number { table: "anticogging", key: "share", value: "1.0".into(), comment };
    let harmonics: Vec<String> = found.cogging(stated.linearity).iter().map(harmonic).collect();
    let cogging = Number {
        table: "device",
        key: "cogging",
        value: format!("[{}]", harmonics.join(", ")),
        comment: "of the map below, for simulation".into(),
    };
    friction.into_iter().chain([cogging, map, share]).collect()
}

/// The friction for the file. Where nothing shows that there is some, a file keeps its own, if it is not more than
/// the measured one.
fn friction(found: &SlowTurns, stated: &Stated) -> Option<Number> {
    let Estimate { lo, hi, .. } = found.least_friction;
    let [lo_text, hi_text] = [lo, hi].map(|torque| significant(torque, 3));
    (lo > 0.0 || stated.has_more_friction(found)).then(|| Number {
        table: "device",
        key: "friction",
        // Rounded down.
        value: significant(0.5 * lo * (1.0 - 5e-3), 3),
        comment: format!("N m, half of the least of {lo_text} to {hi_text} N m at 95 %"),
    })
}

/// A harmonic as `device.cogging` has it.
fn harmonic(Sine { torque, count, phase }: &Sine) -> String {
    let [torque, phase] = [torque, phase].map(|number| {
        let text = significant(*number, 4);
        if text.contains(['.', 'e']) { text } else { text + ".0" }
    });
    format!("{{ torque = {torque}, count = {count}, phase = {phase} }}")
}

/// Largest number of harmonics that the text names.
const NAMED: usize = 3;

fn text(found: &SlowTurns, stated: &Stated, origin: Option<&Origin>, numbers: &[Number]) -> String {
    let of = |e: &Estimate, unit: &str| {
        let reach = significant((e.value - e.lo).max(e.hi - e.value), 2);
        format!("{} +- {reach} {unit}", significant(e.value, 4))
    };
    let [least, most] = found.speeds.map(|speed| significant(speed, 3));
    let [forward, back] = found.turns;
    let range = |e: &Estimate| format!("{} to {} N m", significant(e.lo, 3), significant(e.hi, 3));
    let friction = match found.friction_harmonics.is_empty() {
        true => format!("{}, the same over the turn", range(&found.least_friction)),
        false => format!(
            "{} where it is least, {} in the mean",
            range(&found.least_friction),
            range(&found.friction)
        ),
    };
    let friction = match stated.has_more_friction(found) {
        true => {
            format!("{friction}: less than the {} N m of the file", significant(stated.friction, 3))
        }
        false => friction,
    };
    let mut rows = vec![
        ("turns", format!("{forward} forward, {back} back, at {least} to {most} rad/s")),
        ("friction", friction),
        ("damping", of(&found.damping, "N m s/rad")),
        ("inertia", of(&found.inertia, "kg m^2")),
        ("mean", of(&found.mean, "N m, of a load or the amplifier's offset")),
        ("cogging", cogging(found)),
        ("map", map(found)),
    ];
    rows.extend(remains(found));
    let keeps_map = stated.has_map && !found.tells_cogging();
    rows.extend(keeps_map.then(|| {
        let text = "the file keeps its `[anticogging]`, of which this record shows nothing: remove it if it is of \
                    another motor or encoder";
        ("note", text.to_owned())
    }));
    rows.push(("not resolved", not_resolved(&found.floors, "N m")));
    rows.extend(origin.map(Origin::row));
    let rows: String = rows.iter().map(|(label, value)| format!("{label:<12} {value}\n")).collect();
    let in_file = numbers.iter().map(|Number { table, key, value, comment }| {
        let value = if value.starts_with('[') { "[..]" } else { value };
        let comment = if comment.is_empty() { String::new() } else { format!(" # {comment}") };
        format!("{table}.{key} = {value}{comment}\n")
    });
    format!("{rows}\n{}", in_file.collect::<String>())
}

fn cogging(found: &SlowTurns) -> String {
    let named = found.harmonics.iter().take(NAMED).map(|harmonic| {
        let Estimate { value, lo, hi } = harmonic.amplitude;
        let reach = significant((value - lo).max(hi - value), 2);
        format!("{}: {} +- {reach}", harmonic.count, significant(value, 3))
    });
    let named: Vec<String> = named.collect();
    let more = match found.harmonics.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(", {more} weaker"),
    };
    match named.is_empty() {
        true => "none stands out".to_owned(),
        false => format!("N m by harmonic: {}{more}", named.join(", ")),
    }
}

fn map(found: &SlowTurns) -> String {
    let [most, each] = [found.largest(), found.uncertainty].map(|torque| significant(torque, 2));
    let highest = found.highest;
    let size =
        format!("up to {most} N m, each +- {each} N m with the harmonics up to {highest} a turn");
    match found.tells_cogging() {
        true => format!("{} samples a turn, {size}", found.map.len()),
        false if found.harmonics.is_empty() => format!(
            "none: cogging of {each} N m, of harmonics up to {highest} a turn, may be hidden by the noise"
        ),
        false => format!("none: not told from noise, {size}"),
    }
}

/// The cogging that remains where the map opposes it.
fn remains(found: &SlowTurns) -> Option<(&'static str, String)> {
    let [most, each] = [found.largest(), found.uncertainty].map(|torque| significant(torque, 2));
    let text = format!("up to {each} N m of {most} N m, where the whole map opposes the cogging");
    found.tells_cogging().then_some(("remains", text))
}

/// The amplitudes of harmonics that a record does not show: in the lowest and in the highest range.
pub fn not_resolved(floors: &[Floor], unit: &str) -> String {
    let range = |floor: &Floor| {
        format!("below {} {unit} up to {} a turn", significant(floor.amplitude, 2), floor.highest)
    };
    let ends = floors.first().into_iter().chain(floors.get(1..).and_then(<[Floor]>::last));
    let ends: Vec<String> = ends.map(range).collect();
    format!("harmonics {}, and all above", ends.join(", "))
}
