//! The axes of all charts: their space, grid, names and numbers.

use std::ops::Range;

use plotters::coord::combinators::LogCoord;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::{Area, Drawn, GRID, LABEL, MARGIN, UNITS, X_LABELS, Y_LABELS, pen, text, units};
use crate::quantity::rounded;

/// A chart in an area, with room for the numbers and the names of its axes.
pub fn chart<'a, 'b>(area: &'a Area<'b>) -> ChartBuilder<'a, 'static, SVGBackend<'b>> {
    let mut chart = ChartBuilder::on(area);
    chart.margin(MARGIN).x_label_area_size(X_LABELS).y_label_area_size(Y_LABELS);
    chart
}

/// Labels of the axes.
#[derive(Clone, Copy, Debug)]
pub struct Axes<'n> {
    /// Name of the horizontal axis, with its unit; `None` if it shares the axis of the chart below.
    pub x: Option<&'n str>,
    /// Name of the vertical axis, with its unit.
    pub y: &'n str,
    /// The largest number of labels along the horizontal and the vertical axis.
    pub most: (usize, usize),
    /// Size of the text.
    pub size: i32,
    /// Whether all numbers have an exponent, so that several axes have the same format.
    pub exponents: bool,
}

impl<'n> Axes<'n> {
    /// Axes with these names, in the style of most charts.
    pub fn named(x: impl Into<Option<&'n str>>, y: &'n str) -> Self {
        Self { x: x.into(), y, most: (11, 11), size: LABEL, exponents: false }
    }

    /// Draws axes, grid, names and numbers.
    pub fn draw<X: Numbered, Y: Numbered>(
        &self,
        chart: &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, Y>>,
    ) -> Drawn<()> {
        let like = |scale: Scale| if self.exponents { scale.with_exponents() } else { scale };
        let across = like(X::scale(&chart.x_range()));
        let up = like(Y::scale(&chart.y_range()));
        let (across, up) = (|value: &f64| across.number(*value), |value: &f64| up.number(*value));
        let mut mesh = chart.configure_mesh();
        mesh.light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(UNITS))
            .axis_style(pen(1))
            .set_all_tick_mark_size(units(5))
            .x_labels(self.most.0)
            .y_labels(self.most.1)
            .y_desc(self.y)
            .x_label_formatter(&across)
            .y_label_formatter(&up)
            .label_style(text(self.size));
        if let Some(x) = self.x {
            mesh.x_desc(x);
        }
        mesh.draw()
    }
}

/// A kind of axis.
pub trait Numbered: Ranged<ValueType = f64> + ValueFormatter<f64> {
    /// The number format of an axis with this range.
    fn scale(range: &Range<f64>) -> Scale;
}

impl Numbered for RangedCoordf64 {
    fn scale(range: &Range<f64>) -> Scale {
        Scale::linear(range)
    }
}

impl Numbered for LogCoord<f64> {
    fn scale(range: &Range<f64>) -> Scale {
        Scale::logarithmic(range)
    }
}

/// The number format of an axis: all with plain digits, or all with an exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    digits: usize,
    /// A number with a smaller magnitude is a zero with a rounding error.
    zero: f64,
    is_plain: bool,
}

impl Scale {
    /// Plain digits end here.
    const LONG: f64 = 1e7;

    /// With enough digits to distinguish the numbers of a range.
    pub fn linear(range: &Range<f64>) -> Self {
        let width = (range.end - range.start).abs();
        let largest = range.start.abs().max(range.end.abs());
        let digits = ((largest / width).log10().ceil() as usize + 2).clamp(4, 17);
        let is_plain = (1e-3..Self::LONG).contains(&largest);
        Self { digits, zero: 1e-9 * width, is_plain }
    }

    /// The format of a logarithmic axis.
    pub fn logarithmic(range: &Range<f64>) -> Self {
        let is_plain = range.start >= 1e-4 && range.end < Self::LONG;
        Self { digits: 4, zero: 0.0, is_plain }
    }

    /// Whether numbers have plain digits.
    pub fn is_plain(&self) -> bool {
        self.is_plain
    }

    /// The same with exponents.
    pub fn with_exponents(self) -> Self {
        Self { is_plain: false, ..self }
    }

    /// A number.
    pub fn number(&self, value: f64) -> String {
        let nearest = rounded(value, self.digits);
        match self.is_plain {
            _ if value.abs() <= self.zero => "0".to_owned(),
            true => format!("{nearest}"),
            false => format!("{nearest:e}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_told_apart_however_small_the_numbers_or_their_range() {
        let small = Scale::linear(&(-3e-12..3e-12));
        assert_eq!([1e-12, 2e-12, 1e-28].map(|value| small.number(value)), ["1e-12", "2e-12", "0"]);
        let narrow = Scale::linear(&(0.2..0.200_004));
        assert_ne!(narrow.number(0.200_001), narrow.number(0.200_002));
        assert_eq!(Scale::linear(&(0.0..45.0)).number(3.0 * 0.1), "0.3");
    }

    #[test]
    fn an_axis_writes_all_its_numbers_alike() {
        let written = |scale: Scale, values: &[f64]| {
            values.iter().map(|value| scale.number(*value)).collect::<Vec<_>>()
        };
        let decades = [10.0, 1e6, 1e7];
        assert_eq!(written(Scale::logarithmic(&(3.0..3e7)), &decades), ["1e1", "1e6", "1e7"]);
        assert_eq!(written(Scale::logarithmic(&(3.0..3e6)), &decades[..2]), ["10", "1000000"]);
        assert_eq!(written(Scale::logarithmic(&(1e-5..1.0)), &[1e-5, 0.1]), ["1e-5", "1e-1"]);
        let small = Scale::linear(&(0.0..2e-4));
        assert_eq!(written(small, &[0.0, 5e-5, 1.5e-4]), ["0", "5e-5", "1.5e-4"]);
        // If one axis needs exponents, both have them.
        let plain = Scale::logarithmic(&(3.0..3e6));
        assert!(plain.is_plain());
        assert_eq!(written(plain.with_exponents(), &decades[..2]), ["1e1", "1e6"]);
        let large = Scale::linear(&(0.0..2e7));
        assert_eq!(written(large, &[5e6, 1e7, 1.5e7]), ["5e6", "1e7", "1.5e7"]);
    }
}
