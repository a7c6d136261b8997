//! `haptic chart map`: the verdicts on walls over stiffness and damping, and on torque profiles over torque
//! and number of repetitions.

use std::ops::Range;

use clap::Args;
use haptic_servo::parameter::Parameter;

use super::output::OutputArguments;
use crate::chart::detents::DetentMap;
use crate::chart::map::Overlay;
use crate::chart::{self, Chart, Data};
use crate::command::shared_arguments::SceneArgument;
use crate::command::status::CommandError;
use crate::command::value_parsers::range;
use crate::file::SceneFile;
use crate::profile_curve::DetentLimits;
use crate::progress;
use crate::quantity::{shortened, significant};
use crate::stability_map::border::closed_form_border;
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
    match file.scene.environment.profile() {
        Some(_) => of_profile(&file, ranges),
        None => of_file(&file, ranges, side),
    }
}

/// A range of stiffness and a range of damping, if given.
type Ranges = (Option<Range<f64>>, Option<Range<f64>>);

/// Delays of a map of torque profiles, in samples.
const DELAYS: std::ops::RangeInclusive<usize> = 0..=2;
/// Largest number of repetition numbers in a map.
const COUNTS: u32 = 512;

/// The map of a scene file's torque profile.
pub fn of_profile(file: &SceneFile, (counts, torques): Ranges) -> Result<Chart, CommandError> {
    let scene = &file.scene;
    let no_detents = || CommandError::NoDetents { scene: file.name.clone() };
    let number = |parameter| scene.environment.get(parameter).ok_or_else(no_detents);
    let (count, torque) = (number(Parameter::Count)?, number(Parameter::ProfileTorque)?);
    let counts = counts.unwrap_or(0.0..(2.5 * count).max(8.0).ceil());
    let first = counts.start.max(1.0).ceil() as u32;
    let last = counts.end.max(1.0) as u32;
    let step = (last.saturating_sub(first) / COUNTS).max(1);
    let bar = progress::bar(1 + *DELAYS.end() as u64, "judging profiles");
    let limits = |delay: usize| {
        let limits = DetentLimits::of(scene, delay, (first..=last).step_by(step as usize));
        bar.inc(1);
        limits
    };
    let delay = scene.environment.delay();
    let own = limits(delay);
    let others = DELAYS.filter(|&other| other != delay).map(limits).collect();
    bar.finish_and_clear();
    if own.points.len() < 2 {
        return Err(no_detents());
    }
    // About twice the largest certified torque with the scene's number of repetitions.
    let near = own.points.iter().min_by(|a, b| (a.0 - count).abs().total_cmp(&(b.0 - count).abs()));
    let usual = 2.0 * near.map_or(torque, |point| point.1.max(torque));
    let torques = torques.unwrap_or(0.0..usual);
    if ![&counts, &torques].into_iter().all(chart::is_range) {
        return Err(no_detents());
    }
    let period = significant(1e3 * scene.timing.period, 4);
    let map = DetentMap {
        title: format!("{}: torque profiles, T = {period} ms", shortened(&file.name, 40)),
        own,
        others,
        scene: (count, torque),
        counts,
        torques,
    };
    let picture = chart::detents::detents(&map)?;
    let all = std::iter::once(map.own).chain(map.others);
    let rows = all.flat_map(|DetentLimits { delay, points }| {
        points
            .into_iter()
            .map(move |(count, torque)| vec![(delay as f64).into(), count.into(), torque.into()])
    });
    let header = &["delay (samples)", "repetitions in a turn", "largest torque (N m)"];
    Ok(Chart { picture, data: Data::new(header, rows) })
}

/// The map of a scene file's walls, of `side` times `side` cells.
pub fn of_file(
    file: &SceneFile,
    (stiffness, damping): Ranges,
    side: usize,
) -> Result<Chart, CommandError> {
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
    let period = significant(1e3 * file.scene.timing.period, 4);
    let overlay = Overlay {
        title: format!("{}: walls of delay {delay}, T = {period} ms", shortened(&file.name, 40)),
        border: closed_form_border(&family, &map),
        scene: wall.map_or((0.0, 0.0), |wall| (wall.stiffness, wall.damping())),
    };
    let picture = chart::map::map(&map, &overlay)?;
    let row = |(k, b, region): (f64, f64, Region)| vec![k.into(), b.into(), region.as_str().into()];
    let header = &["stiffness (N m/rad)", "damping (N m s/rad)", "region"];
    Ok(Chart { picture, data: Data::new(header, map.cells().map(row)) })
}
