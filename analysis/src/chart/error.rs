//! The errors of a chart.

use std::ops::Range;
use std::path::PathBuf;

use thiserror::Error;

use crate::nyquist::NoTransfer;
use crate::quantity::significant;

/// The reason why a chart could not be drawn, as its sentence says.
#[derive(Debug, Error)]
pub enum ChartError {
    /// `what` is the content of the file.
    #[error("{path}: the {what} cannot be written: {source}")]
    Output { path: PathBuf, what: &'static str, source: std::io::Error },
    #[error("{path}: the name of a picture must end in .svg, that of its numbers in .csv")]
    Extension { path: PathBuf },
    #[error("{path}: the name of a picture's numbers must end in .csv")]
    DataExtension { path: PathBuf },
    #[error("{output} has the numbers already; --csv {csv} needs a chart as output")]
    TwoTables { output: PathBuf, csv: PathBuf },
    #[error("the picture cannot be drawn: {0}")]
    Drawing(String),
    #[error(transparent)]
    NoTransfer(#[from] NoTransfer),
    #[error(
        "there is nothing to draw from {} to {} on the {axis} axis: the data go from {} to {}",
        number(wanted.start), number(wanted.end), number(there.start), number(there.end)
    )]
    NothingThere { axis: &'static str, wanted: Range<f64>, there: Range<f64> },
    #[error("a picture needs at least two points")]
    TooFewPoints,
}

fn number(value: f64) -> String {
    significant(value, 6)
}
