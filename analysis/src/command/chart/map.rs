//! `haptic chart map`: what becomes of walls of every stiffness and damping.

use std::ops::Range;

use clap::Args;

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
use crate::stability_map::{Family, Map, MapError, Region};

/// Arguments of `haptic chart map`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub scene: SceneArgument,
    /// Range of the stiffness in N m/rad, the horizontal axis; default: to about twice the largest
    /// certified spring
    #[arg(long, visible_alias = "x", value_name = "MIN..MAX", value_parser = range,
          allow_hyphen_values = true)]
    pub stiffness: Option<Range<f64>>,
    /// Range of the damping in N m s/rad, the vertical axis; default: to about the damping of the
    /// device
    #[arg(long, visible_alias = "y", value_name = "MIN..MAX", value_parser = range,
          allow_hyphen_values = true)]
    pub damping: Option<Range<f64>>,
    /// Number of scenes, on a square grid
    #[arg(long, value_name = "N", default_value_t = 1_000_000,
          value_parser = clap::value_parser!(u64).range(4..=25_000_000))]
    pub points: u64,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Judges the walls and draws them.
pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let file = arguments.scene.load()?;
    let side = (arguments.points as f64).sqrt().ceil() as usize;
    let ranges = (arguments.stiffness.clone(), arguments.damping.clone());
    of_file(&file, ranges, side)
}

/// A range of stiffness and one of damping, where they are given.
type Ranges = (Option<Range<f64>>, Option<Range<f64>>);

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
        scene: wall.map_or((0.0, 0.0), |wall| (wall.stiffness, wall.damping)),
    };
    let picture = chart::map::map(&map, &overlay)?;
    let row = |(k, b, region): (f64, f64, Region)| vec![k.into(), b.into(), region.as_str().into()];
    let header = &["stiffness (N m/rad)", "damping (N m s/rad)", "region"];
    Ok(Chart { picture, data: Data::new(header, map.cells().map(row)) })
}
