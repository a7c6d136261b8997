//! `haptic chart`: pictures of scenes.

use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use firmware::scene::Coupling;

use super::{Answer, CommandError};
use crate::chart::limits::DelayCurve;
use crate::chart::map::Overlay;
use crate::chart::trace::Trace;
use crate::chart::{self, ChartError, Output, Picture};
use crate::file::{self, Purpose, SceneFile};
use crate::limits::{Curves, Limit, at_period, largest_stiffness, with_wall};
use crate::map::border::closed_form_border;
use crate::map::{Family, Map, MapError};
use crate::progress;
use crate::quantity::{shortened, significant};
use crate::recorded::{self, RecordedError};
use crate::simulation::wall;

/// Arguments of `haptic chart`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Which picture.
    #[command(subcommand)]
    pub kind: Kind,
}

/// Which picture.
#[derive(Debug, Subcommand)]
pub enum Kind {
    /// The curves of (T z/(z-1)) E(z) of one or more scenes, with the line -delta
    Nyquist(Nyquist),
    /// What is certified, stable and unstable, over stiffness and damping of a scene's wall
    Map(MapArguments),
    /// The largest certified stiffness over the sample rate, with the encoder's torque ripple
    Limits(Limits),
    /// What a scene's simulation or a recorded run does, with the ground shaded by what limits it
    Trace(TraceArguments),
    /// The responses of a measured device in their disk, with the device that was fitted to them
    Identify(Identify),
}

/// Arguments of `haptic chart nyquist`.
#[derive(Debug, Args)]
pub struct Nyquist {
    /// Scene files, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE", required = true, num_args = 1..=6)]
    pub files: Vec<String>,
    /// Title of the picture; otherwise the scene's name
    #[arg(long)]
    pub title: Option<String>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Arguments of `haptic chart map`.
#[derive(Debug, Args)]
pub struct MapArguments {
    /// Scene file, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Stiffness from:to in N m/rad; otherwise about twice the stiffest certified spring's
    #[arg(long, value_name = "FROM:TO", value_parser = range, allow_hyphen_values = true)]
    pub stiffness: Option<Range<f64>>,
    /// Damping from:to in N m s/rad; otherwise about as far as the device's own goes
    #[arg(long, value_name = "FROM:TO", value_parser = range, allow_hyphen_values = true)]
    pub damping: Option<Range<f64>>,
    /// Number of scenes to judge, on a square grid
    #[arg(long, value_name = "N", default_value_t = 1_000_000,
          value_parser = clap::value_parser!(u64).range(4..=25_000_000))]
    pub points: u64,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Arguments of `haptic chart limits`.
#[derive(Debug, Args)]
pub struct Limits {
    /// Scene file, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Sample rates from:to in Hz
    #[arg(long, value_name = "FROM:TO", value_parser = positive_range, default_value = "500:100000")]
    pub rates: Range<f64>,
    /// Counts of the encoder a turn
    #[arg(long, value_name = "N", value_parser = counts, default_value = "65536")]
    pub counts_per_rev: f64,
    /// Part of the largest stiffness that is used, for the ripple: at all of it there is no bound
    #[arg(long, value_name = "PART", value_parser = part, default_value = "0.7")]
    pub used: f64,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Arguments of `haptic chart trace`.
#[derive(Debug, Args)]
pub struct TraceArguments {
    /// Scene file with a simulation table, TOML or JSON, `-` being standard input; or a .csv from
    /// `haptic run --csv` or `haptic simulate --csv`
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Period of the servo in s, for a .csv that counts ticks
    #[arg(long, value_name = "SECONDS", value_parser = super::identify::positive)]
    pub period: Option<f64>,
    /// Title of the picture; otherwise the scene's or the file's name
    #[arg(long)]
    pub title: Option<String>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Arguments of `haptic chart identify`.
#[derive(Debug, Args)]
pub struct Identify {
    /// Record of stepped sines, as `haptic identify` reads it; `-` is standard input
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// Counts of the encoder in one turn
    #[arg(long, value_name = "N", value_parser = super::identify::positive)]
    pub counts_per_rev: f64,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: super::identify::Reading,
    /// Title of the picture; otherwise the file's name
    #[arg(long)]
    pub title: Option<String>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Where a picture goes.
#[derive(Debug, Args)]
pub struct OutputArguments {
    /// The picture's file, .svg or .png
    #[arg(short, long, value_name = "PICTURE")]
    pub output: PathBuf,
}

/// Draws the picture and writes it. The name of its file is looked at first, so that nobody waits
/// for a picture that cannot be kept.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let to = match &arguments.kind {
        Kind::Nyquist(arguments) => &arguments.output,
        Kind::Map(arguments) => &arguments.output,
        Kind::Limits(arguments) => &arguments.output,
        Kind::Trace(arguments) => &arguments.output,
        Kind::Identify(arguments) => &arguments.output,
    };
    let output = Output::new(&to.output)?;
    let picture = match &arguments.kind {
        Kind::Nyquist(arguments) => nyquist(arguments)?,
        Kind::Map(arguments) => map(arguments)?,
        Kind::Limits(arguments) => limits(arguments)?,
        Kind::Trace(arguments) => trace(arguments)?,
        Kind::Identify(arguments) => {
            let Identify { file, counts_per_rev, reading, .. } = arguments;
            let found = super::identify::of_file(file, *counts_per_rev, reading)?;
            let name = || file.file_stem().unwrap_or_default().to_string_lossy();
            let title = arguments.title.clone().unwrap_or_else(|| format!("Measured: {}", name()));
            chart::identify::identify(&title, &found)?
        }
    };
    output.write(&picture)?;
    Ok(Answer::Yes)
}

fn nyquist(arguments: &Nyquist) -> Result<Picture, CommandError> {
    let files: Result<Vec<_>, _> = arguments.files.iter().map(|file| file::load(file)).collect();
    let scenes: Vec<_> = files?.into_iter().map(|file| (file.name, file.scene)).collect();
    let title = match (&arguments.title, &scenes[..]) {
        (Some(title), _) => title.clone(),
        (None, [(name, _)]) => name.clone(),
        _ => "From velocity to torque: (T z/(z-1)) E(z)".to_owned(),
    };
    Ok(chart::nyquist::nyquist(&title, &scenes)?)
}

fn map(arguments: &MapArguments) -> Result<Picture, CommandError> {
    let file = file::load(&arguments.file)?;
    let side = (arguments.points as f64).sqrt().ceil() as usize;
    let ranges = (arguments.stiffness.clone(), arguments.damping.clone());
    Ok(draw_map(&file, ranges, side)?)
}

fn trace(arguments: &TraceArguments) -> Result<Picture, CommandError> {
    let path = Path::new(&arguments.file);
    let mut drawn = if recorded::is_recorded(path) {
        recorded::load(path, arguments.period)?
    } else if arguments.period.is_some() {
        return Err(RecordedError::PeriodKnown { file: arguments.file.clone() }.into());
    } else {
        let file = file::load_for(Purpose::Simulate, &arguments.file)?;
        Trace::simulated(&file, path.parent().unwrap_or(Path::new("")))?
    };
    if let Some(title) = &arguments.title {
        drawn.title.clone_from(title);
    }
    Ok(chart::trace::trace(&drawn)?)
}

/// A range of stiffness and one of damping, where they are given.
type Ranges = (Option<Range<f64>>, Option<Range<f64>>);

/// The map of a scene file's walls, of `side` times `side` cells.
pub(super) fn draw_map(
    file: &SceneFile,
    (stiffness, damping): Ranges,
    side: usize,
) -> Result<Picture, MapError> {
    let family = Family::of(file)?;
    let usual = family.usual_ranges();
    let bar = progress::bar(side as u64, "judging walls");
    let (stiffness, damping) = (stiffness.unwrap_or(usual.0), damping.unwrap_or(usual.1));
    let map = Map::new(&family, stiffness, damping, side, || bar.inc(1));
    bar.finish_and_clear();
    let wall = wall(&file.scene);
    let delay = wall.map_or(0, |wall| wall.delay);
    let period = significant(1e3 * file.scene.timing.period, 4);
    let overlay = Overlay {
        title: format!("{}: walls of delay {delay}, T = {period} ms", shortened(&file.name, 40)),
        border: closed_form_border(&family, &map),
        scene: wall.map_or((0.0, 0.0), |wall| (wall.stiffness, wall.damping)),
    };
    Ok(chart::map::map(&map, &overlay)?)
}

/// Longest delay in the picture of limits, in samples.
const DELAYS: usize = 4;
/// Sample rates in the picture of limits.
const RATES: usize = 61;

fn limits(arguments: &Limits) -> Result<Picture, CommandError> {
    let file = file::load(&arguments.file)?;
    if wall(&file.scene).is_none() {
        return Err(MapError::NoWall { scene: file.name }.into());
    }
    let curves = Curves {
        rates: arguments.rates.clone(),
        points: RATES,
        counts_per_turn: arguments.counts_per_rev,
        used: arguments.used,
    };
    let bar = progress::bar(DELAYS as u64 + 1, "limits");
    let drawn: Vec<_> = (0..=DELAYS)
        .map(|delay| {
            let points = curves.of(&file.scene, delay);
            let slowest = at_period(&file.scene, 1.0 / curves.rates.start);
            let undelayed = with_wall(&slowest, 0.0, Some(delay));
            bar.inc(1);
            let is_coupling = largest_stiffness(&undelayed) == Limit::Any;
            DelayCurve { delay, is_coupling, points }
        })
        .collect();
    bar.finish_and_clear();
    let coupling = match file.scene.coupling {
        Coupling::Rigid => "rigid coupling",
        Coupling::Spring { .. } => "behind the standard coupling 2 delta/T",
    };
    let note = format!(
        "ripple of half a count of {} a turn, at {} % of the largest stiffness, {coupling}",
        significant(curves.counts_per_turn, 7),
        significant(100.0 * curves.used, 3)
    );
    let title = format!("{}: how stiff, how fast", shortened(&file.name, 48));
    chart::limits::limits(&title, &note, &drawn).map_err(|error| match error {
        ChartError::TooFewPoints => CommandError::NoStiffness { scene: file.name.clone() },
        other => other.into(),
    })
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not finite")) }
}

fn range(text: &str) -> Result<Range<f64>, String> {
    let (from, to) = text.split_once(':').ok_or("it must be two numbers with a colon between")?;
    let range = number(from)?..number(to)?;
    if range.start < range.end {
        Ok(range)
    } else {
        Err(format!("{} must be less than {}", range.start, range.end))
    }
}

fn positive_range(text: &str) -> Result<Range<f64>, String> {
    let range = range(text)?;
    if range.start > 0.0 { Ok(range) } else { Err(format!("{} must be above 0", range.start)) }
}

fn counts(text: &str) -> Result<f64, String> {
    let counts = number(text)?;
    if counts >= 1.0 { Ok(counts) } else { Err(format!("{counts} must be at least 1")) }
}

fn part(text: &str) -> Result<f64, String> {
    let part = number(text)?;
    if part > 0.0 && part < 1.0 { Ok(part) } else { Err(format!("{part} must be between 0 and 1")) }
}
