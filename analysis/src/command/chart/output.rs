//! The output file of a chart, and its visible part.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;

use crate::chart::{Chart, ChartError, Picture, Window, has_extension};
use crate::command::status::{CommandError, CommandStatus};
use crate::command::value_parsers::range;

/// The output files of a chart and its numbers.
#[derive(Debug, Args)]
pub struct OutputArguments {
    /// File of the chart, .svg; or .csv for its numbers only
    #[arg(short, long, value_name = "PICTURE")]
    pub output: PathBuf,
    /// Also write the numbers of the chart to this .csv
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct WindowArguments {
    /// Range of the horizontal axis, in its unit; default: all data
    #[arg(long, value_name = "MIN..MAX", value_parser = range, allow_hyphen_values = true)]
    pub x: Option<Range<f64>>,
    /// Range of the vertical axis, in its unit; default: all data
    #[arg(long, value_name = "MIN..MAX", value_parser = range, allow_hyphen_values = true)]
    pub y: Option<Range<f64>>,
}

impl WindowArguments {
    pub(super) fn window(&self) -> Window {
        Window { x: self.x.clone(), y: self.y.clone() }
    }
}

/// Files whose names state their content.
#[derive(Debug)]
pub struct Files {
    picture: Option<PathBuf>,
    data: Option<PathBuf>,
}

impl OutputArguments {
    /// Draws a chart and writes it, if its files have valid names.
    pub(super) fn write(
        &self,
        draw: impl FnOnce() -> Result<Chart, CommandError>,
    ) -> Result<CommandStatus, CommandError> {
        let files = self.files()?;
        files.write(draw()?)?;
        Ok(CommandStatus::Success)
    }

    /// Checks the file names before the work: the picture could not be saved otherwise.
    pub(super) fn files(&self) -> Result<Files, ChartError> {
        let (output, csv) = (self.output.clone(), self.csv.clone());
        let is_data = has_extension(&output, "csv");
        match csv {
            Some(path) if !has_extension(&path, "csv") => Err(ChartError::DataExtension { path }),
            Some(csv) if is_data => Err(ChartError::TwoTables { output, csv }),
            None if is_data => Ok(Files { picture: None, data: Some(output) }),
            data => {
                Picture::check_name(&output)?;
                Ok(Files { picture: Some(output), data })
            }
        }
    }
}

impl Files {
    pub(super) fn write(&self, Chart { picture, data }: Chart) -> Result<(), ChartError> {
        self.picture.as_ref().map_or(Ok(()), |path| picture.write(path))?;
        self.data.as_ref().map_or(Ok(()), |path| data.write(path))
    }
}
