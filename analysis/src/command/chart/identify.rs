//! `haptic chart identify`: the responses of a measured device in the disk of its passivity.

use std::path::PathBuf;

use clap::Args;

use super::output::OutputArguments;
use crate::chart::{self, Chart, Data};
use crate::command::identify::{Reading, of_file};
use crate::command::status::CommandError;
use crate::command::value_parsers::counts;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Record of stepped sines, as for `haptic identify`; `-` is standard input
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// Encoder counts per turn
    #[arg(long, value_name = "N", value_parser = counts, allow_hyphen_values = true)]
    pub counts_per_rev: f64,
    #[command(flatten)]
    pub reading: Reading,
    /// Title of the chart; default: the name of the file
    #[arg(long)]
    pub title: Option<String>,
    #[command(flatten)]
    pub output: OutputArguments,
}

pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let Arguments { file, counts_per_rev, reading, .. } = arguments;
    let found = of_file(file, *counts_per_rev, reading)?;
    let name = || file.file_stem().unwrap_or_default().to_string_lossy();
    let title = arguments.title.clone().unwrap_or_else(|| format!("Measured: {}", name()));
    let picture = chart::identify::identify(&title, &found)?;
    let rows: Vec<_> = found
        .responses
        .iter()
        .map(|response| {
            let hertz = response.omega / std::f64::consts::TAU;
            vec![hertz.into(), response.admittance.re.into(), response.admittance.im.into()]
        })
        .collect();
    let header = "frequency (Hz),real part of J (rad/(N m s)),imaginary part of J (rad/(N m s))";
    Ok(Chart { picture, data: Data::new(header, rows) })
}
