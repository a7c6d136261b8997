//! `haptic chart map`: the verdicts on walls over stiffness and damping, and on torque profiles over torque
//! and number of repetitions.

use std::ops::Range;

use clap::Args;
use haptic_servo::parameter::Parameter;

use super::output::OutputArguments;
use crate::chart::map::Overlay;
use crate::chart::{self, Chart, Data};
use crate::command::shared_arguments::SceneArgument;
use crate::command::status::CommandError;
use crate::command::value_parsers::range;
use crate::file::SceneFile;
use crate::progress;
use crate::quantity::{shortened, significant};
use crate::stability_map::border::closed_form_border;
use crate::stability_map::plane::Plane;
use crate::stability_map::{Family, Map, MapError, Region};

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub scene: SceneArgument,
    /// Range of the stiffness in N m/rad, the horizontal axis; default: to about twice the largest
    /// certified spring. Of a torque profile, that of its number of repetitions in a turn
    #[arg(long, visible_alias = "x", value_name = "MIN..MAX", value_parser = range,
          allow_hyphen_values = true)]
    pub stiffness: Option<Range<f64>>,
    /// Range of the damping in N m s/rad, the vertical axis; default: to about the damping of the
    /// device. Of a torque profile, that of its torque in N m
    #[arg(long, visible_alias = "y", value_name = "MIN..MAX", value_parser = range,
          allow_hyphen_values = true)]
    pub damping: Option<Range<f64>>,
    /// Number of scenes, on a square grid
    #[arg(long, value_name = "N", default_value_t = 1_000_000,
          value_parser = clap::value_parser!(u64).range(4..=25_000_000))]
    pub points: u64,
    #[command(flatten)]
    pub output: OutputArguments,
}

pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let file = arguments.scene.load()?;
    let side = (arguments.points as f64).sqrt().ceil() as usize;
    let ranges = (arguments.stiffness.clone(), arguments.damping.clone());
    let (map, overlay) = match file.scene.environment.profile() {
        Some(_) => of_profile(&file, ranges, side)?,
        None => of_walls(&file, ranges, side)?,
    };
    let picture = chart::map::map(&map, &overlay)?;
    let row = |(x, y, region): (f64, f64, Region)| vec![x.into(), y.into(), region.as_str().into()];
    let header = format!("{},region", overlay.labels.join(","));
    Ok(Chart { picture, data: Data::new(header, map.cells().map(row)) })
}

/// The ranges of both axes, if given.
type Ranges = (Option<Range<f64>>, Option<Range<f64>>);

/// The map of a scene file's torque profile: a column for each number of repetitions, and at most `side`
/// columns.
fn of_profile(
    file: &SceneFile,
    (counts, torques): Ranges,
    side: usize,
) -> Result<(Map, Overlay), CommandError> {
    let no_detents = || CommandError::NoDetents { scene: file.name.clone() };
    if !Plane::choice(&file.scene).contains(&Parameter::Count) {
        return Err(no_detents());
    }
    let plane = Plane::of(file, [Parameter::Count, Parameter::ProfileTorque])?;
    let [usual_counts, usual_torques] = plane.usual_ranges();
    let (counts, torques) = (counts.unwrap_or(usual_counts), torques.unwrap_or(usual_torques));
    let (first, last) = (counts.start.max(1.0).ceil(), counts.end.floor());
    let counts = first - 0.5..last + 0.5;
    if ![&counts, &torques].into_iter().all(chart::is_range) {
        return Err(no_detents());
    }
    let columns = ((last - first) as usize).min(side - 1) + 1;
    let bar = progress::bar(side as u64, "judging profiles");
    let map = Map::of_plane(&plane, [counts, torques], [columns, side], || bar.inc(1));
    bar.finish_and_clear();
    let overlay = Overlay {
        title: title(file, "torque profiles"),
        labels: ["repetitions in a turn", "torque (N m)"],
        says_stability: plane.says_stability(),
        border: None,
        scene: plane.own().into(),
    };
    Ok((map, overlay))
}

/// The map of a scene file's walls, of `side` times `side` cells.
fn of_walls(
    file: &SceneFile,
    (stiffness, damping): Ranges,
    side: usize,
) -> Result<(Map, Overlay), CommandError> {
    let family = Family::of(file)?;
    let usual = family.usual_ranges();
    let (stiffness, damping) = (stiffness.unwrap_or(usual.0), damping.unwrap_or(usual.1));
    if ![&stiffness, &damping].into_iter().all(chart::is_range) {
        return Err(MapError::NoRange { stiffness, damping }.into());
    }
    let bar = progress::bar(side as u64, "judging walls");
    let map = Map::new(&family, stiffness, damping, side, || bar.inc(1));
    bar.finish_and_clear();
    let wall = file.scene.environment.wall();
    let delay = wall.map_or(0, |wall| wall.delay);
    let overlay = Overlay {
        title: title(file, &format!("walls of delay {delay}")),
        labels: ["stiffness (N m/rad)", "damping (N m s/rad)"],
        says_stability: true,
        border: closed_form_border(&family, &map),
        scene: wall.map_or((0.0, 0.0), |wall| (wall.stiffness, wall.damping())),
    };
    Ok((map, overlay))
}

fn title(file: &SceneFile, what: &str) -> String {
    let period = significant(1e3 * file.scene.timing.period, 4);
    format!("{}: {what}, T = {period} ms", shortened(&file.name, 40))
}
