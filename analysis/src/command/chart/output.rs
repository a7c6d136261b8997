//! The output file of a chart, and its visible part.

use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::chart::{Chart, ChartError, Output, Window};
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

/// Ranges of the axes.
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
    /// The ranges, for a drawing.
    pub(super) fn window(&self) -> Window {
        Window { x: self.x.clone(), y: self.y.clone() }
    }
}

/// Files whose names state their content.
#[derive(Debug)]
pub struct Files {
    picture: Option<Output>,
    data: Option<PathBuf>,
}

impl OutputArguments {
    /// Checks the file names before the work: the picture could not be saved otherwise.
    pub(super) fn files(&self) -> Result<Files, ChartError> {
        let is_data = |path: &Path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
        match &self.csv {
            Some(path) if !is_data(path) => Err(ChartError::DataExtension { path: path.clone() }),
            Some(path) if is_data(&self.output) => {
                Err(ChartError::TwoTables { output: self.output.clone(), csv: path.clone() })
            }
            None if is_data(&self.output) => {
                Ok(Files { picture: None, data: Some(self.output.clone()) })
            }
            data => Ok(Files { picture: Some(Output::new(&self.output)?), data: data.clone() }),
        }
    }
}

impl Files {
    /// Writes the files of a chart.
    pub(super) fn write(&self, Chart { picture, data }: Chart) -> Result<(), ChartError> {
        if let Some(output) = &self.picture {
            output.write(&picture)?;
        }
        self.data.as_ref().map_or(Ok(()), |path| data.write(path))
    }
}
