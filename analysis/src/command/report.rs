//! `haptic report`: one page about a scene.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::chart::{map, profile};
use super::shared_arguments::{CoefficientFormat, SceneArgument};
use super::status::{CommandError, CommandStatus};
use crate::chart::nyquist::nyquist;
use crate::chart::trace::{drawable, trace};
use crate::chart::{ChartError, Window};
use crate::date;
use crate::report::{Figure, Page};
use crate::simulation::SimulationError;
use crate::stability_map::MapError;
use crate::terminal;
use crate::text_width;
use crate::trace::Trace;

/// Arguments of `haptic report`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub scene: SceneArgument,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub arithmetic: CoefficientFormat,
    /// File of the page, .html
    #[arg(short, long, value_name = "PAGE")]
    pub output: PathBuf,
}

/// Cells of the map in each direction: as fine as a page shows, and fast to judge.
const SIDE: usize = 400;

/// Writes the page and prints the verdict; the status is that of `haptic certify`.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let extension = arguments.output.extension().map(|e| e.to_string_lossy().to_lowercase());
    if !matches!(extension.as_deref(), Some("html" | "htm")) {
        return Err(CommandError::NoPage { path: arguments.output.clone() });
    }
    let file = arguments.scene.load()?;
    let report = arguments.arithmetic.judge(&file)?;
    let named = [(file.name.clone(), file.scene)];
    let profile = match profile::of_file(&file) {
        Err(CommandError::NoProfile { .. }) => None,
        drawn => Some(drawn?.picture),
    };
    let map = match &profile {
        Some(_) => map::of_profile(&file, (None, None)),
        None => map::of_file(&file, (None, None), SIDE),
    };
    let map = match map {
        Err(error @ CommandError::NoDetents { .. }) => missing(&error.to_string()),
        Err(CommandError::Map(MapError::NoWall { .. })) => {
            missing("The environment has no wall, so there is no map of stiffness and damping.")
        }
        Err(CommandError::Map(error @ (MapError::Device(_) | MapError::NoRange { .. }))) => {
            missing(&error.to_string())
        }
        drawn => Figure::Drawn(drawn?.picture),
    };
    let motion = if file.simulation.is_some() {
        match Trace::simulated(&file, arguments.scene.folder()) {
            Err(error @ SimulationError::TooFast { .. }) => missing(&error.to_string()),
            moved => motion(&drawable(moved?))?,
        }
    } else {
        missing("The scene has no [simulation] table, so there is no simulation.")
    };
    let nyquist =
        match nyquist("From velocity to torque: (T z/(z-1)) E(z)", &named, &Window::default()) {
            Err(ChartError::NoTransfer(_)) if profile.is_some() => {
                missing("A torque profile has no transfer function, and so no Nyquist curve.")
            }
            Err(ChartError::NoTransfer(_)) => {
                missing("The environment has no transfer function to draw.")
            }
            drawn => Figure::Drawn(drawn?),
        };
    let (path, date) = (arguments.scene.file.as_str(), date::today()?);
    let page = Page { report: &report, file: &file, path, date, profile, nyquist, map, motion };
    std::fs::write(&arguments.output, page.html())
        .map_err(|source| CommandError::Unwritable { path: arguments.output.clone(), source })?;
    let said = format!("{}: {}\n", arguments.output.display(), report.message);
    let said = text_width::wrapped(&said, terminal::output_width(), 0);
    io::stdout().lock().write_all(said.as_bytes())?;
    Ok(if report.passes() { CommandStatus::Success } else { CommandStatus::NegativeVerdict })
}

fn missing(why: &str) -> Figure {
    Figure::Missing(why.to_owned())
}

/// The chart of a run, or the reason why there is none.
fn motion(moved: &Trace) -> Result<Figure, ChartError> {
    match (trace(moved, &Window::default()), moved.lost) {
        (Err(ChartError::TooFewPoints), Some(_)) => {
            Ok(missing("The motion is too large for a chart from its start on."))
        }
        (drawn, _) => Ok(Figure::Drawn(drawn?)),
    }
}
