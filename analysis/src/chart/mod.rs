//! Charts as SVG: black on white, curves distinguished by line style and labelled in place, to
//! be readable in print.

pub mod axes;
pub mod bode;
pub mod cell_polygons;
pub mod dash;
pub mod data;
pub mod detents;
mod error;
pub mod failures;
pub mod growth;
pub mod hatch;
pub mod identify;
mod labels;
pub mod latency;
pub mod limits;
pub mod map;
pub mod nyquist;
pub mod picture;
mod plot_area;
pub mod profile;
mod strokes;
pub mod trace;
pub mod tradeoff;
pub mod turn;

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use data::{Cell, Chart, Data};
pub use error::ChartError;
pub use picture::{Output, Picture};
use strokes::join_strokes;

/// Width and height of a picture in pixels.
pub const SIZE: (u32, u32) = (820, 560);

/// Units of the drawing in a pixel. Coordinates are whole numbers, and a curve on whole pixels
/// would be jagged.
const UNITS: u32 = 8;

/// Font of all text; every viewer has one by this name.
const FONT: &str = "sans-serif";
/// Size of titles.
const TITLE: i32 = units(19);
/// Size of axis labels and of labels in the picture.
const LABEL: i32 = units(14);
/// Room above a title, in pixels.
const TOP: i32 = 10;
/// Height of a title with the room above it, in pixels.
const TITLE_ROOM: i32 = TOP + 26;
/// Room around a picture.
const MARGIN: i32 = units(14);
/// Room on the right, for the last number of the time axis.
const MARGIN_RIGHT: i32 = units(24);
/// Room for the numbers and the name of a horizontal axis.
const X_LABELS: i32 = units(48);
/// The same for a vertical axis.
const Y_LABELS: i32 = units(78);
/// Grey of forbidden regions.
const FORBIDDEN: RGBColor = RGBColor(225, 225, 225);
/// Grey of a secondary curve.
const FAINT: RGBColor = RGBColor(150, 150, 150);
/// Grey of grid lines.
const GRID: RGBColor = RGBColor(235, 235, 235);

/// Pixels in units of the drawing.
const fn units(pixels: i32) -> i32 {
    pixels * UNITS as i32
}

/// A black line with a width in pixels.
fn pen(width: u32) -> ShapeStyle {
    BLACK.stroke_width(width * UNITS)
}

/// A broken line: pixels of ink, pixels of gap, width.
fn broken(
    points: impl IntoIterator<Item = (f64, f64)>,
    ink: i32,
    gap: i32,
    width: u32,
) -> DashedLineSeries<std::vec::IntoIter<(f64, f64)>, i32> {
    let points: Vec<_> = points.into_iter().collect();
    DashedLineSeries::new(points, units(ink), units(gap), pen(width))
}

/// Ranges of the axes, in place of the default ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Window {
    /// Along the horizontal axis.
    pub x: Option<Range<f64>>,
    /// Along the vertical axis.
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

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn<T> = Result<T, DrawingAreaErrorKind<std::io::Error>>;
type Plane<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws a picture of the usual size.
fn draw(picture: impl FnOnce(&Area<'_>) -> Drawn<()>) -> Result<Picture, ChartError> {
    draw_sized(SIZE, picture)
}

/// Draws a picture with a size in pixels.
fn draw_sized(
    size: (u32, u32),
    picture: impl FnOnce(&Area<'_>) -> Drawn<()>,
) -> Result<Picture, ChartError> {
    let (width, height) = (size.0 * UNITS, size.1 * UNITS);
    let mut svg = String::new();
    let drawn = {
        let area = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        area.fill(&WHITE).and_then(|()| picture(&area)).and_then(|()| area.present())
    };
    drawn.map_err(|error| ChartError::Drawing(error.to_string()))?;
    // The drawing keeps its units; only its size on the page is in pixels.
    let drawing = format!("width=\"{width}\" height=\"{height}\" viewBox");
    let page = format!("width=\"{}\" height=\"{}\" viewBox", size.0, size.1);
    Ok(Picture::new(join_strokes(&svg.replacen(&drawing, &page, 1))))
}

fn text(size: i32) -> TextStyle<'static> {
    TextStyle::from((FONT, size)).color(&BLACK)
}

/// Text with its anchor on the given side.
fn anchored(horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    text(LABEL).pos(Pos::new(horizontal, vertical))
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

/// Whether a value can be on an axis: small enough that ranges do not overflow.
fn is_drawable(value: f64) -> bool {
    value.abs() <= 1e300
}

/// Whether an axis can have this range: drawable ends, with distinguishable numbers between them.
pub fn is_range(range: &Range<f64>) -> bool {
    let width = range.end - range.start;
    is_drawable(range.start) && is_drawable(range.end) && width >= f64::MIN_POSITIVE
}

/// The range of some values; from zero to zero if there are none.
fn span(values: impl Iterator<Item = f64>) -> Range<f64> {
    let mut finite = values.filter(|value| is_drawable(*value));
    let first = finite.next().unwrap_or(0.0);
    finite.fold(first..first, |range, value| range.start.min(value)..range.end.max(value))
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
