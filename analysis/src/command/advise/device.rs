//! `haptic advise device`: what a motor, an encoder, a rate and an amplifier make possible, before they are
//! bought.

use std::path::{Path, PathBuf};

use clap::Args;
use haptic_servo::certificate::{QuantizationBound, passivity_for_anticogging};
use haptic_servo::environment::{MOST_KNOTS, Wall};
use haptic_servo::number::Format;
use haptic_servo::parameter::Parameter;
use haptic_servo::period;
use haptic_servo::scene::{Coupling, Device, Scene};
use haptic_servo::servo::BuildError;
use serde::Serialize;

use crate::chart::{self, Data, Picture, has_extension};
use crate::command::shared_arguments::{JsonOption, warned};
use crate::command::status::{CommandError, CommandStatus};
use crate::command::value_parsers::positive;
use crate::design::stiffest::{Search, Wall as StiffestWall};
use crate::design::{Choice, Judge, Terms};
use crate::disturbance::Disturbance;
use crate::file::{self, SceneFile, key};
use crate::quantity::{rounded, significant};
use crate::text_table::table_of;
use crate::verdict::judge_file;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Device file, with `[encoder]` and `[limits]`, or scene file, of which the environment does not count
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Updates of the torque in a second, for a device file
    #[arg(long, value_name = "HZ", value_parser = positive, allow_hyphen_values = true)]
    pub rate: Option<f64>,
    /// Write the stiffness over the rate into this chart (.svg), or its numbers (.csv)
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Stiffness at the handle in N m/rad at a rate; null if no wall is.
#[derive(Debug, Serialize)]
struct Point {
    rate: f64,
    certified: Option<f64>,
    silent: Option<f64>,
}

/// A change of the device, and what it buys.
#[derive(Debug, Serialize)]
struct Lever {
    change: &'static str,
    /// Of the stiffness that is silent at rest, or else of that which certifies; infinite, and null in JSON, where
    /// there is none without the change.
    factor: f64,
}

#[derive(Debug, Serialize)]
struct Report {
    name: String,
    /// In Hz.
    rate: f64,
    /// At the handle, in N m/rad; null if no wall certifies.
    stiffness: Option<f64>,
    /// The key without which no wall certifies.
    needed: Option<&'static str>,
    /// Why not even a wall without stiffness certifies, and a change with which it does; null where one does, and
    /// where it is for the needed key.
    rejection: Option<String>,
    remedy: Option<String>,
    structure: Option<&'static str>,
    /// Largest torque error in N m of that wall at rest; null without counts of an encoder.
    torque_error: Option<f64>,
    /// In N m, as stated.
    friction: Option<f64>,
    /// Stiffness in N m/rad up to which the friction prevents a limit cycle at rest.
    silent_stiffness: Option<f64>,
    /// Most detents in a turn, and the peak torque of each in N m.
    detents: Option<f64>,
    detent_torque: Option<f64>,
    /// Why there are none; null where it is not known, either.
    no_detents: Option<String>,
    /// Part of the cogging whose compensation certifies, at most 1; null without cogging.
    compensated: Option<f64>,
    /// Keys without which the silent stiffness and the detents are not known.
    missing: Vec<&'static str>,
    /// Why these are not known of a motor that a board's own bridge does not drive; null where it does.
    no_bridge: Option<String>,
    /// The largest factor first.
    levers: Vec<Lever>,
    points: Vec<Point>,
}

/// Runs the command; the status is negative if no wall certifies.
pub fn run(arguments: &Arguments, answer: &JsonOption) -> Result<CommandStatus, CommandError> {
    if let Some(output) = arguments.output.as_deref().filter(|path| !has_extension(path, "csv")) {
        Picture::check_name(output)?;
    }
    let file = with_wall(load(arguments)?);
    on_a_board(&file)
        .map_err(|error| CommandError::Failed(format!("{}: {error}", arguments.file).into()))?;
    let Some(search) = Search::new(&file, &TERMS) else {
        return Err(CommandError::NoSuchQuantity { scene: file.name, quantity: "wall" });
    };
    let report = report(&file, &search.without_rest());
    if let Some(output) = &arguments.output {
        let title =
            format!("{}: stiffness at the handle", crate::quantity::shortened(&file.name, 32));
        let curves = curves(&report);
        let row =
            |name: &str, &(rate, felt): &(f64, f64)| vec![name.into(), rate.into(), felt.into()];
        let rows =
            curves.iter().flat_map(|(name, curve)| curve.iter().map(move |it| row(name, it)));
        let data = Data::new("wall,rate (Hz),felt stiffness (N m/rad)", rows.collect::<Vec<_>>());
        match has_extension(output, "csv") {
            true => data.write(output)?,
            false => chart::stiffest::stiffest(&title, &curves, None, Some(report.rate))?
                .write(output)?,
        }
    }
    answer.print(&report, text)?;
    Ok(CommandStatus::of(report.stiffness.is_some()))
}

/// A board judges, and the structure of the search has its own coupling.
const TERMS: Terms = Terms {
    safety: 1.0,
    coupling: Choice::Kept,
    judge: Judge::BOARD,
    exact: false,
    full_scale: None,
};

/// The scene file, or a scene on the device of the device file.
fn load(arguments: &Arguments) -> Result<SceneFile, CommandError> {
    let name = &arguments.file;
    let is_scene = file::load_json(name)?.get("servo").is_some();
    match (is_scene, arguments.rate) {
        (true, None) => Ok(warned(file::load(name)?)),
        (true, Some(rate)) => {
            let error =
                format!("--rate {rate}: {name} is a scene file, and its `servo` states the rate");
            Err(CommandError::Failed(error.into()))
        }
        (false, None) => {
            let error = format!("{name} is a device file, which states no rate: add --rate HZ");
            Err(CommandError::Failed(error.into()))
        }
        (false, Some(rate)) => {
            let of_file = || Path::new(name).file_stem().map(|stem| stem.to_string_lossy().into());
            let title = file::load_device(name)?.name.or_else(of_file).unwrap_or_default();
            let scene = format!(
                "name = {}\ndevice = {}\n[servo]\nrate = {rate:?}\n[environment]\n\
                 type = \"damper-wall\"\nstiffness = 1.0\ndamping = 0.0\ndelay = 1\n",
                serde_json::Value::from(title.as_str()),
                serde_json::Value::from(name.as_str())
            );
            Ok(warned(file::parse(name, file::Format::Toml, &scene)?))
        }
    }
}

/// The device with a wall of springs, latched at the next sample.
fn with_wall(mut file: SceneFile) -> SceneFile {
    let learnt = file.scene.environment.parts().anticogging;
    let wall = Wall::damped(1.0, 0.0, 1).alone();
    file.scene.environment = learnt.map_or(wall, |learnt| wall.beside(learnt));
    file.scene.coupling = Coupling::Rigid;
    file.shapes = None;
    file
}

/// Checks what no scene on this device changes: a period, a torque limit and counts that a board has.
fn on_a_board(file: &SceneFile) -> Result<(), BuildError> {
    let Scene { timing, torque_limit, latency, .. } = file.scene;
    period::check(timing.period)?;
    file.transducers(None, None).check(timing, latency.encoder, torque_limit)
}

fn report(file: &SceneFile, search: &Search) -> Report {
    let period = file.scene.timing.period;
    let best = search.at(period);
    let silent = search.silent();
    let of_wall = |wall: &StiffestWall| SceneFile { scene: wall.scene, ..file.clone() };
    let bound = |wall: &StiffestWall| {
        QuantizationBound::of(&wall.scene, Format::F64, &of_wall(wall).steps())
    };
    let rest = best.as_ref().and_then(bound);
    // A wall that is silent anyhow needs no search of its own.
    let felt_silently = |period: f64, certified: Option<&StiffestWall>| match &silent {
        Some(silent) => silent.at(period).map(|wall| wall.felt),
        None => certified
            .filter(|wall| bound(wall).is_some_and(|it| it.comes_to_rest() == Some(true)))
            .map(|wall| wall.felt),
    };
    let silent_stiffness = felt_silently(period, best.as_ref());
    let points = search.periods().into_iter().rev().map(|period| {
        let certified = search.at(period);
        let silent = felt_silently(period, certified.as_ref());
        Point { rate: rounded(period.recip(), 6), certified: certified.map(|it| it.felt), silent }
    });
    let needed = needed(&file.scene.device);
    let rejected = (best.is_none() && needed.is_none()).then(|| rejected(file)).flatten();
    let (rejection, remedy) = rejected.unzip();
    let torque = detent_torque(file);
    let detents = silent
        .as_ref()
        .filter(|_| silent_stiffness.is_some())
        .map(|silent| silent.most_detents(torque, period));
    let (detents, no_detents) = detents.map_or((None, None), |found| (found.ok(), found.err()));
    Report {
        name: file.name.clone(),
        rate: rounded(period.recip(), 6),
        stiffness: best.map(|wall| wall.felt),
        needed,
        rejection,
        remedy: remedy.flatten(),
        structure: best.map(|wall| wall.structure.name()),
        torque_error: file.encoder_step.and(rest).map(|it| it.hum()),
        friction: file.friction,
        silent_stiffness,
        detents,
        detent_torque: detents.map(|_| torque),
        no_detents: no_detents.map(|why| why.to_string()),
        compensated: compensated(file, best.as_ref().map_or(&file.scene, |wall| &wall.scene)),
        missing: missing(file),
        no_bridge: best.as_ref().and_then(|wall| of_wall(wall).own_bridge().err()),
        levers: levers(silent.as_ref().unwrap_or(search), period),
        points: points.collect(),
    }
}

/// The key of which a device without passivity states 0.
fn needed(device: &Device) -> Option<&'static str> {
    let key = if device.damping == 0.0 { key::DEVICE_DAMPING } else { key::PASSIVITY };
    (device.passivity() == 0.0).then_some(key.path)
}

/// The reason why the wall of a file is rejected even without stiffness, and the first of the remedies; `None` if it
/// is not.
fn rejected(file: &SceneFile) -> Option<(String, Option<String>)> {
    let scene = file.scene.with(Parameter::Stiffness, 0.0)?;
    let report = judge_file(&SceneFile { scene, ..file.clone() }, Format::F64);
    let is_rejected = !report.passes();
    is_rejected.then(|| (report.summary, report.remedies.into_iter().next()))
}

/// The keys that a bound on the torque at rest and the friction against it need.
fn missing(file: &SceneFile) -> Vec<&'static str> {
    let needed = [
        (&key::DEVICE_FRICTION, file.friction.is_some()),
        (&key::COUNTS_PER_TURN, file.encoder_step.is_some()),
        (&key::FULL_SCALE, file.full_scale.is_some()),
    ];
    needed.into_iter().filter(|(_, is_stated)| !is_stated).map(|(key, _)| key.path).collect()
}

/// The peak torque in N m of a detent that can be told apart: twice that of friction and of the cogging that remains.
fn detent_torque(file: &SceneFile) -> f64 {
    let Disturbance { friction, cogging } = file.disturbance();
    let Scene { environment, latency, .. } = &file.scene;
    let remains = match environment.parts().anticogging {
        Some(learnt) if file.cogging.is_some() => {
            cogging.remaining(&learnt, latency.encoder.linearity)
        }
        _ => cogging.torque(),
    };
    2.0 * (friction + remains)
}

/// The part of the cogging that can be opposed with all of the device's passivity and the times of a scene: of the
/// learnt map, or of the stated cogging on a map that has 16 angles or more in a period of it.
fn compensated(file: &SceneFile, scene: &Scene) -> Option<f64> {
    let learnt = match (file.scene.environment.parts().anticogging, file.cogging) {
        (Some(learnt), _) => learnt,
        (None, Some(cogging)) => {
            let angles = (16 * cogging.highest() as usize).next_power_of_two();
            cogging.learnt(angles.min(MOST_KNOTS as usize)).ok()?
        }
        (None, None) => return None,
    };
    let delay = scene.environment.wall().map_or(1, |wall| wall.delay);
    let passes = |share: f64| {
        let environment = Wall::spring(0.0, delay).alone().beside(learnt.sharing(share));
        let needed = passivity_for_anticogging(&Scene { environment, ..*scene }, Format::F64);
        needed.is_some_and(|needed| needed < scene.device.passivity())
    };
    if passes(1.0) {
        return Some(1.0);
    }
    let (mut most, mut beyond) = (0.0, 1.0);
    for _ in 0..32 {
        let share = 0.5 * (most + beyond);
        if passes(share) { most = share } else { beyond = share }
    }
    Some(most)
}

/// The curves of the chart.
fn curves(report: &Report) -> Vec<(&'static str, Vec<(f64, f64)>)> {
    let of = |felt: fn(&Point) -> Option<f64>| {
        report.points.iter().filter_map(|point| Some((point.rate, felt(point)?))).collect()
    };
    vec![("certified", of(|it| it.certified)), ("silent at rest", of(|it| it.silent))]
}

/// Single changes and their factors at this period in s, the largest first.
fn levers(search: &Search, period: f64) -> Vec<Lever> {
    let felt = |search: &Search, period| search.at(period).map_or(0.0, |wall| wall.felt);
    let own = felt(search, period);
    let same_rate = search.levers().into_iter().filter(|lever| lever.0 != Search::FASTER_BOARD);
    let mut levers: Vec<_> = same_rate
        .map(|(change, search)| (change, felt(&search, period)))
        .chain([("twice the rate", felt(search, 0.5 * period))])
        .filter(|&(_, felt)| own.max(felt) > 0.0)
        .map(|(change, felt)| Lever { change, factor: felt / own })
        .collect();
    levers.sort_by(|a, b| b.factor.total_cmp(&a.factor));
    levers
}

fn text(report: &Report) -> String {
    let number = |value: f64, unit: &str| format!("{} {unit}", significant(value, 3));
    let stiffness = |value| number(value, "N m/rad");
    let unknown = || match report.stiffness {
        None => Some("no wall certifies".to_owned()),
        Some(_) if report.missing.is_empty() => {
            report.no_bridge.as_ref().map(|_| "not known".to_owned())
        }
        Some(_) => Some(format!("not known: state `{}`", report.missing.join("`, `"))),
    };
    let certified = report.stiffness.map_or_else(
        || match report.needed {
            Some(key) => format!("none: `{key}` is 0, and a device without it is not passive"),
            None => match &report.rejection {
                Some(why) => format!("none: {}", why.trim_start_matches("rejected: ")),
                None => "none".to_owned(),
            },
        },
        |felt| format!("{}, {}", stiffness(felt), report.structure.unwrap_or_default()),
    );
    let error = report.torque_error.map_or_else(
        || match &report.no_bridge {
            Some(why) => format!("not known: {why}"),
            None => unknown().unwrap_or_default(),
        },
        |error| match report.friction {
            Some(friction) => {
                let [error, friction] = [error, friction].map(|it| number(it, "N m"));
                format!("{error}, and the device has {friction} of friction")
            }
            None => number(error, "N m"),
        },
    );
    let detents = report.detents.zip(report.detent_torque).map_or_else(
        || {
            let why = report.no_detents.as_deref().unwrap_or("no wall is silent");
            unknown().unwrap_or_else(|| format!("none: {why}"))
        },
        |(count, torque)| format!("{count} a turn, of {}", number(torque, "N m")),
    );
    let cogging = report.compensated.map(|part| match part {
        1.0 => "all of it".to_owned(),
        0.0 => "nothing of it".to_owned(),
        _ => format!("{} % of it", significant(100.0 * part, 2)),
    });
    let first = match (report.needed, report.levers.first()) {
        (Some(key), _) => format!("`{key}`"),
        (None, Some(Lever { change, factor: f64::INFINITY })) => {
            format!("{change}: there is none without")
        }
        (None, Some(Lever { change, factor })) if *factor > 1.005 => {
            format!("{change}: {} x", significant(*factor, 3))
        }
        (None, None) if report.stiffness.is_none() => {
            report.remedy.clone().unwrap_or_else(|| "no single change is enough".to_owned())
        }
        (None, _) => "no single change earns more".to_owned(),
    };
    let silent = report.silent_stiffness.map_or_else(
        || unknown().unwrap_or_else(|| "no wall is, with this friction".to_owned()),
        stiffness,
    );
    let rows = [
        (format!("stiffest certified wall at {} Hz", significant(report.rate, 4)), Some(certified)),
        ("its torque error at rest".to_owned(), Some(error)),
        ("silent at rest up to".to_owned(), Some(silent)),
        ("detents that can be told apart".to_owned(), Some(detents)),
        ("cogging that can be compensated".to_owned(), cogging),
        ("to be changed first".to_owned(), Some(first)),
    ];
    let rows: Vec<_> =
        rows.into_iter().filter_map(|(question, answer)| Some((question, answer?))).collect();
    let name = report.name.clone();
    let table = table_of(
        &rows,
        &[
            ("of this device", false, |row: &(String, String)| row.0.clone()),
            ("", false, |row: &(String, String)| row.1.clone()),
        ],
    );
    format!("{name}\n{table}\n")
}
