//! `haptic design stiffest`: the stiffest wall at the handle that certifies on a board.

use clap::Args;
use serde::Serialize;
use std::path::Path;

use super::answer::object;
use crate::chart::{self, Chart, Data, has_extension};
use crate::command::shared_arguments::write;
use crate::command::status::{CommandError, CommandStatus};
use crate::design::Judge;
use crate::design::stiffest::{Found, Search, Structure, Wall};
use crate::felt;
use crate::file::{self, SceneFile};
use crate::progress;
use crate::quantity::{rounded, shortened, significant};
use crate::text_table::table_of;
use crate::toolchain::BoardModel;
use crate::verdict::{AtRest, VerdictReport, judge_file};

/// Arguments of `haptic design stiffest`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file with a wall
    pub file: String,
    /// The board; all render the same scenes, but only one with a bridge those with `device.actuator_updates`
    #[arg(long, value_parser = BoardModel::find)]
    pub board: Option<BoardModel>,
}

/// A change of the device or the board, and what it buys.
#[derive(Serialize)]
struct Lever {
    change: &'static str,
    /// In N m/rad; null if no wall certifies.
    felt_stiffness: Option<f64>,
    /// Of the found stiffness.
    factor: f64,
}

/// A point of a structure's curve.
#[derive(Serialize)]
struct Point {
    structure: &'static str,
    rate: f64,
    felt_stiffness: f64,
}

/// The answer as JSON.
#[derive(Serialize)]
struct Report {
    name: String,
    structure: &'static str,
    felt_stiffness: f64,
    /// Of the file as it was.
    felt_stiffness_before: Option<f64>,
    /// The instant of the torque in s after its count, of the file as it was.
    output_delay_before: f64,
    certified_before: bool,
    margin: Option<f64>,
    /// Of the stiffest wall that the stated friction keeps silent at rest; null if no friction is stated, or if
    /// no wall is silent.
    silent_stiffness: Option<f64>,
    /// Whether a stiffer environment would certify and earn nothing.
    saturates: bool,
    scene: serde_json::Value,
    levers: Vec<Lever>,
    curves: Vec<Point>,
}

/// Runs the command; the status is negative if no wall certifies, or if no board's bridge drives the motor.
pub fn run(all: &super::Arguments, arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let file = all.load(&arguments.file)?;
    let is_bridge = file.scene.latency.actuator_updates > 0;
    if let Some(board) = arguments.board.filter(|board| is_bridge && !board.has_bridge()) {
        let error = format!(
            "{}: `device.actuator_updates` needs a bridge, which {board} has not",
            file.name
        );
        return Err(CommandError::Failed(error.into()));
    }
    let Some(search) = Search::new(&file, &all.terms()) else {
        return Err(CommandError::NoSuchQuantity { scene: file.name, quantity: "wall" });
    };
    let levers = search.levers();
    let rates = search.rates() * (levers.len() + 1);
    let bar = progress::bar(rates as u64, "stiffest wall");
    let Some(found) = search.run(|| bar.inc(1)) else {
        bar.finish_and_clear();
        let nothing = serde_json::json!({ "name": file.name, "felt_stiffness": null });
        all.answer.print(&nothing, |_| format!("{}: no wall certifies on a board\n", file.name))?;
        return Ok(CommandStatus::NegativeVerdict);
    };
    let lever = |(change, search): (&'static str, Search)| {
        let felt_stiffness = search.run(|| bar.inc(1)).map(|found| found.best.felt);
        let factor = felt_stiffness.unwrap_or(0.0) / found.best.felt;
        Lever { change, felt_stiffness, factor }
    };
    let mut levers: Vec<_> = levers.into_iter().map(lever).collect();
    bar.finish_and_clear();
    levers.sort_by(|a, b| b.factor.total_cmp(&a.factor));
    let stiffest = SceneFile { scene: found.best.scene, ..file.clone() };
    if let Some(output) = &all.output {
        save(output, &arguments.file, &stiffest, &found)?;
    }
    let verdict = judge_file(&stiffest, haptic_servo::number::Format::F64);
    let silent = search.silent().map(|search| search.run(|| ()).map(|found| found.best));
    let silent_stiffness = match &silent {
        None if verdict.rest.is_some_and(|rest| rest.comes_to_rest == Some(true)) => {
            Some(found.best.felt)
        }
        silent => silent.flatten().map(|wall| wall.felt),
    };
    let report = Report { silent_stiffness, ..report(&file, &stiffest, &found, &verdict, levers)? };
    all.answer.print(&report, |report| {
        let silent = silent.map(|wall| silent_in_words(wall.as_ref()));
        text(report, &stiffest, &found.best, &verdict, silent)
    })?;
    Ok(CommandStatus::of(verdict.board.is_none()))
}

fn report(
    file: &SceneFile,
    stiffest: &SceneFile,
    found: &Found,
    verdict: &VerdictReport,
    levers: Vec<Lever>,
) -> Result<Report, CommandError> {
    Ok(Report {
        name: file.name.clone(),
        structure: found.best.structure.name(),
        felt_stiffness: found.best.felt,
        felt_stiffness_before: felt::stiffness(&file.scene),
        output_delay_before: file.scene.latency.code_delay(file.scene.timing.period),
        certified_before: Judge::BOARD.passes(&file.scene),
        margin: verdict.margin_on_board,
        silent_stiffness: None,
        saturates: found.best.saturates,
        scene: object(stiffest)?,
        levers,
        curves: found.walls.iter().map(point).collect(),
    })
}

fn point(wall: &Wall) -> Point {
    let rate = rounded(wall.scene.timing.period.recip(), 6);
    Point { structure: wall.structure.name(), rate, felt_stiffness: wall.felt }
}

/// The stiffest wall that is silent at rest, or none.
fn silent_in_words(wall: Option<&Wall>) -> String {
    wall.map_or("no wall is, with the stated friction".to_owned(), |wall| {
        format!(
            "up to {} N m/rad at the handle, with the stated friction: {} at {} Hz",
            significant(wall.felt, 3),
            wall.structure.name(),
            significant(wall.scene.timing.period.recip(), 3)
        )
    })
}

/// The friction that a wall needs to be silent at rest.
fn rest_in_words(rest: &AtRest, full_scale: Option<f64>) -> String {
    let motor = full_scale.filter(|&full_scale| rest.hum > full_scale);
    let needed = match motor {
        Some(motor) => format!(
            "a limit cycle of up to {} N m is possible, more than the {} N m of the motor",
            significant(rest.hum, 3),
            significant(motor, 3)
        ),
        None => {
            format!(
                "{} N m of friction prevent a limit cycle",
                significant(rest.friction_for_rest, 3)
            )
        }
    };
    let of_device = match (rest.friction, rest.comes_to_rest) {
        (None, _) => "; with `device.friction` in the file, the stiffest silent wall is named, too"
            .to_owned(),
        (Some(friction), Some(false)) => format!("; the device has {friction} N m"),
        (Some(friction), _) => format!(", and the device has {friction} N m"),
    };
    needed + &of_device
}

fn text(
    report: &Report,
    file: &SceneFile,
    best: &Wall,
    verdict: &VerdictReport,
    silent: Option<String>,
) -> String {
    let scene = &file.scene;
    let number = |value: f64, unit: &str| format!("{} {unit}", significant(value, 3));
    let stiffness = number(best.felt, "N m/rad");
    let before = report.felt_stiffness_before.map_or_else(String::new, |before| {
        let refused = if report.certified_before { "" } else { ", which no board certifies" };
        let factor = significant(best.felt / before, 3);
        format!(", {factor} x the {} of the file{refused}", number(before, "N m/rad"))
    });
    let (period, latency) = (scene.timing.period, &scene.latency);
    let rate = number(period.recip(), "Hz");
    let (delay, stated) = (latency.code_delay(period), report.output_delay_before);
    let instead = match stated != 0.0 && stated != delay && latency.actuator_updates == 0 {
        true => format!(
            ", in place of {} in the file: what an amplifier adds is `encoder.age`",
            number(stated * 1e6, "us")
        ),
        false => String::new(),
    };
    let output = match delay == 0.0 {
        true => "latched at the next sample".to_owned(),
        false => format!("{} after the count", number(delay * 1e6, "us")),
    } + &instead;
    let wall = scene.environment.wall().map_or_else(String::new, |wall| {
        let filter = wall.filter().map_or_else(String::new, |pole| format!(", filter {pole}"));
        let stiffness = number(wall.stiffness, "N m/rad");
        format!("{stiffness}, damping {}{filter}", number(wall.damping(), "N m s/rad"))
    });
    let compliance = felt::compliance(scene).filter(|&compliance| compliance > 0.0);
    let coupling = compliance.map_or("none".to_owned(), |compliance| {
        let coupling = number(1.0 / compliance, "N m/rad");
        match best.saturates {
            true => {
                format!("{coupling}: a stiffer wall certifies, and earns nothing at the handle")
            }
            false => coupling,
        }
    });
    let rest = verdict.rest.map(|rest| rest_in_words(&rest, file.full_scale));
    let rows = [
        ("felt stiffness", Some(stiffness + &before)),
        ("structure", Some(report.structure.to_owned())),
        ("rate", Some(format!("{rate}, period {period:?} s"))),
        ("output", Some(output)),
        ("wall", Some(wall)),
        ("coupling", Some(coupling)),
        ("margin on a board", verdict.margin_on_board_in_words()),
        ("not on a board", verdict.board.clone()),
        ("at rest", rest),
        ("silent at rest", silent),
    ];
    let rows =
        rows.into_iter().filter_map(|(label, value)| Some(format!("{label:<18} {}\n", value?)));
    let table = table_of(
        &report.levers,
        &[
            ("felt stiffness", true, |lever| match lever.factor > 1.005 {
                true => format!("{} x", significant(lever.factor, 3)),
                false => "earns nothing".to_owned(),
            }),
            ("with one change", false, |lever| lever.change.to_owned()),
        ],
    );
    rows.collect::<String>() + &format!("{table}\n")
}

/// Writes the scene, the chart or its numbers, by the extension.
fn save(output: &Path, from: &str, file: &SceneFile, found: &Found) -> Result<(), CommandError> {
    let is_chart = ["svg", "csv"].iter().any(|extension| has_extension(output, extension));
    if !is_chart {
        let text = file::write::toml(file);
        return write(output, file::naming(&text, from, output).unwrap_or(text));
    }
    let Chart { picture, data } = chart(file, found)?;
    match has_extension(output, "csv") {
        true => Ok(data.write(output)?),
        false => Ok(picture.write(output)?),
    }
}

fn chart(file: &SceneFile, found: &Found) -> Result<Chart, CommandError> {
    let title = format!("{}: stiffest certified wall at the handle", shortened(&file.name, 32));
    let place = |wall: &Wall| (wall.scene.timing.period.recip(), wall.felt);
    let curve = |structure: Structure| {
        let walls = found.walls.iter().filter(|wall| wall.structure == structure);
        (structure.name(), walls.map(place).collect::<Vec<_>>())
    };
    let curves = Structure::ALL.into_iter().map(curve).filter(|(_, curve)| !curve.is_empty());
    let curves: Vec<_> = curves.collect();
    let picture = chart::stiffest::stiffest(&title, &curves, Some(place(&found.best)), None)?;
    let row =
        |point: Point| vec![point.structure.into(), point.rate.into(), point.felt_stiffness.into()];
    let rows: Vec<_> = found.walls.iter().map(point).map(row).collect();
    let data = Data::new("structure,rate (Hz),felt stiffness (N m/rad)", rows);
    Ok(Chart { picture, data })
}
