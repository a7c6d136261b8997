//! The errors of a chart.

use std::ops::Range;
use std::path::PathBuf;

use thiserror::Error;

use crate::nyquist::NoTransfer;
use crate::quantity::significant;

/// The reason why a chart could not be drawn.
#[derive(Debug, Error)]
pub enum ChartError {
    /// The file could not be written.
    #[error("{path}: the picture cannot be written: {source}")]
    Output {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The numbers could not be written.
    #[error("{path}: the numbers cannot be written: {source}")]
    Data {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The file's name does not give the kind of picture.
    #[error("{path}: the name of a picture must end in .svg, that of its numbers in .csv")]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// The file of the numbers has another name.
    #[error("{path}: the name of a picture's numbers must end in .csv")]
    DataExtension {
        /// The file.
        path: PathBuf,
    },
    /// Both files would contain the numbers.
    #[error("{output} has the numbers already; --csv {csv} needs a chart as output")]
    TwoTables {
        /// The file of the picture.
        output: PathBuf,
        /// The file of the numbers.
        csv: PathBuf,
    },
    /// The drawing failed.
    #[error("the picture cannot be drawn: {0}")]
    Drawing(String),
    /// The scene has no transfer function to draw.
    #[error(transparent)]
    NoTransfer(#[from] NoTransfer),
    /// The requested axis has no data.
    #[error(
        "there is nothing to draw from {} to {} on the {axis} axis: the data go from {} to {}",
        number(wanted.start), number(wanted.end), number(there.start), number(there.end)
    )]
    NothingThere {
        /// Horizontal or vertical.
        axis: &'static str,
        /// The requested range.
        wanted: Range<f64>,
        /// The range of the data.
        there: Range<f64>,
    },
    /// There is nothing to draw.
    #[error("a picture needs at least two points")]
    TooFewPoints,
}

fn number(value: f64) -> String {
    significant(value, 6)
}
