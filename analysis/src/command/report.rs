//! `haptic report`: one page about a scene.

use std::path::{Path, PathBuf};

use clap::Args;

use super::chart::draw_map;
use super::{Answer, CommandError};
use crate::chart::ChartError;
use crate::chart::nyquist::nyquist;
use crate::chart::trace::{Trace, trace};
use crate::file;
use crate::map::MapError;
use crate::report::{Figure, Page};
use crate::verdict::{Verdict, judge};

/// Arguments of `haptic report`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: String,
    /// The page, .html
    #[arg(short, long, value_name = "PAGE")]
    pub output: PathBuf,
}

/// Cells of the map in each direction: as fine as a page shows, and judged in a moment.
const SIDE: usize = 400;

/// Writes the page. The answer is the scene's verdict, as that of `haptic certify`.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let extension = arguments.output.extension().map(|e| e.to_string_lossy().to_lowercase());
    if !matches!(extension.as_deref(), Some("html" | "htm")) {
        return Err(CommandError::NoPage { path: arguments.output.clone() });
    }
    let file = file::load(&arguments.file)?;
    let report = judge(&file.name, &file.scene);
    let named = [(file.name.clone(), file.scene)];
    let map = match draw_map(&file, (None, None), SIDE) {
        Err(MapError::NoWall { .. }) => Figure::Missing(
            "The environment has no wall, whose stiffness and damping a map would show.",
        ),
        drawn => Figure::Drawn(drawn?),
    };
    let motion = if file.simulation.is_some() {
        let folder = Path::new(&arguments.file).parent().unwrap_or(Path::new(""));
        Figure::Drawn(trace(&Trace::simulated(&file, folder)?)?)
    } else {
        Figure::Missing("The scene has no [simulation] table, which would say what to simulate.")
    };
    let nyquist = match nyquist("From velocity to torque: (T z/(z-1)) E(z)", &named) {
        Err(ChartError::NoTransfer { .. }) => {
            Figure::Missing("The environment has no transfer function to draw.")
        }
        drawn => Figure::Drawn(drawn?),
    };
    let page = Page { report: &report, scene: &file.scene, nyquist, map, motion };
    std::fs::write(&arguments.output, page.html())
        .map_err(|source| CommandError::Unwritable { path: arguments.output.clone(), source })?;
    Ok(if report.verdict == Verdict::Certified { Answer::Yes } else { Answer::No })
}
