//! `haptic chart trace`: a run over time, simulated or recorded.

use std::path::Path;

use clap::Args;

use super::output::{OutputArguments, WindowArguments};
use crate::chart::trace::{data, drawable, trace};
use crate::chart::{Chart, ChartError};
use crate::command::shared_arguments::folder;
use crate::command::status::{CommandError, CommandStatus};
use crate::file::{self, Purpose};
use crate::run_csv::{self, RunCsvError};
use crate::trace::Trace;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file with a table `simulation`, TOML or JSON, `-` is standard input; or a .csv from
    /// `haptic run --csv` or `haptic simulate --csv`
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Period of the servo in s, for a .csv with tick numbers
    #[arg(long, value_name = "SECONDS", value_parser = crate::command::value_parsers::positive)]
    pub period: Option<f64>,
    /// Torque limit in N m to draw, for a .csv; a scene file has it
    #[arg(long, value_name = "N M", value_parser = crate::command::value_parsers::positive)]
    pub torque_limit: Option<f64>,
    /// Title of the chart; default: the name of the scene or the file
    #[arg(long)]
    pub title: Option<String>,
    #[command(flatten)]
    pub window: WindowArguments,
    #[command(flatten)]
    pub output: OutputArguments,
}

/// Draws the run and writes the chart; the status is negative if the chart cannot show all of it.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let files = arguments.output.files()?;
    let run = drawable(load(arguments)?);
    let left_out = run.lost.map(|_| CommandError::LeftOut { sample: run.time.len() });
    match (trace(&run, &arguments.window.window()), left_out) {
        (Err(ChartError::TooFewPoints), Some(left_out)) => Err(left_out),
        (drawn, left_out) => {
            files.write(Chart { picture: drawn?, data: data(run) })?;
            left_out.map_or(Ok(CommandStatus::Success), Err)
        }
    }
}

fn load(arguments: &Arguments) -> Result<Trace, CommandError> {
    let path = Path::new(&arguments.file);
    let mut drawn = if run_csv::is_run_csv(path) {
        run_csv::load(path, arguments.period)?
    } else if arguments.period.is_some() {
        return Err(RunCsvError::PeriodKnown { file: arguments.file.clone() }.into());
    } else {
        let file = file::load_for(Purpose::Simulate, &arguments.file)?;
        Trace::simulated(&file, folder(&arguments.file))?
    };
    drawn.torque_limit = arguments.torque_limit.or(drawn.torque_limit);
    if let Some(title) = &arguments.title {
        drawn.title.clone_from(title);
    }
    Ok(drawn)
}
