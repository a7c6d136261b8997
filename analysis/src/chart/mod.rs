//! Charts as SVG: black on white, curves distinguished by line style and explained in a legend, to be
//! readable in print.

mod axis;
mod base;
pub mod bode;
pub mod budget;
pub mod cell_polygons;
pub mod data;
mod error;
pub mod failures;
mod frame;
pub mod growth;
pub mod hatch;
pub mod identify;
mod labels;
pub mod latency;
mod legend;
pub mod limits;
pub mod map;
mod mark;
pub mod nyquist;
mod page;
mod palette;
mod panel;
pub mod picture;
pub mod profile;
pub mod stiffest;
mod stroke;
mod strokes;
pub mod trace;
pub mod tradeoff;
pub mod turn;

use std::ops::Range;

use plotters::prelude::*;

// What charts are made of, for `use super::*` in each of them.
use axis::Axis;
use base::*;
pub use data::{Cell, Chart, Data};
pub use error::ChartError;
use hatch::{Direction, Fill};
use legend::Sample;
use mark::Mark;
use page::{HEIGHT, Page, WIDTH};
use palette::FORBIDDEN;
use panel::Panel;
pub use picture::{Picture, has_extension};
use stroke::Stroke;

use crate::nyquist::{is_drawable, span};

/// Ranges of the axes, in place of the default ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Window {
    pub x: Option<Range<f64>>,
    pub y: Option<Range<f64>>,
}

/// Rejects a requested axis that does not overlap this range.
fn meets(
    axis: &'static str,
    wanted: Option<&Range<f64>>,
    there: &Range<f64>,
) -> Result<(), ChartError> {
    match wanted {
        Some(wanted) if wanted.end < there.start || there.end < wanted.start => {
            Err(ChartError::NothingThere { axis, wanted: wanted.clone(), there: there.clone() })
        }
        _ => Ok(()),
    }
}

/// A range with room on both sides; never empty.
fn padded(range: Range<f64>, part: f64) -> Range<f64> {
    let (middle, half) = (0.5 * (range.start + range.end), 0.5 * (range.end - range.start));
    let level = half <= middle.abs() * f64::EPSILON;
    let half = match level {
        // A hundredth of a constant to both sides; around zero a fixed range.
        true if middle != 0.0 => 0.01 * middle.abs(),
        true => 1e-9,
        false => half * (1.0 + 2.0 * part),
    };
    middle - half..middle + half
}

/// Whether an axis can have this range: drawable ends, with distinguishable numbers between them.
pub fn is_range(range: &Range<f64>) -> bool {
    let width = range.end - range.start;
    is_drawable(range.start) && is_drawable(range.end) && width >= f64::MIN_POSITIVE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_never_empty_and_hold_what_they_are_of() {
        assert_eq!(padded(1.0..3.0, 0.25), 0.5..3.5);
        for value in [0.0, 0.2, -7e9, 1e-30, 1e300] {
            let range = padded(value..value, 0.1);
            assert!(range.start < value && value < range.end, "{range:?}");
        }
        assert_eq!(padded(-1e-20..1e-20, 0.0), -1e-20..1e-20);
    }
}
