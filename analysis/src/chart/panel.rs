//! A panel of a picture: axes, and curves, regions and marks between them.

use plotters::prelude::*;

use super::axis::Axis;
use super::base::{Area, Drawn, LABEL, UNITS, text, units};
use super::frame::{Frame, Place, whole};
use super::mark::Mark;
use super::palette::GRID;
use super::stroke::Stroke;

const MARGIN: i32 = units(14);
/// Room on the right, for the last number of the horizontal axis.
const MARGIN_RIGHT: i32 = units(24);
/// Room for the numbers of a horizontal axis, and with its name.
const NUMBERS: i32 = units(24);
const NUMBERS_AND_NAME: i32 = units(48);
/// Room for the numbers and the name of a vertical axis.
const BESIDE: i32 = units(78);
/// Smallest distances of the ticks on a horizontal and a vertical axis, in pixels, and their largest number.
const TICKS_APART: (i32, i32) = (62, 28);
const MOST_TICKS: usize = 11;

pub struct Panel<'a, 'b> {
    chart: ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>,
    x: Axis,
    y: Axis,
    /// The area between the axes, in units of the drawing from its upper left corner.
    pub area: Area<'b>,
    /// The whole of it.
    pub frame: Frame,
}

impl<'a, 'b> Panel<'a, 'b> {
    /// A panel with its axes and grid.
    pub fn new(area: &'a Area<'b>, x: Axis, y: Axis) -> Drawn<Self> {
        Self::headed(area, "", x, y)
    }

    /// The same below a line of words, if there are any.
    pub fn headed(area: &'a Area<'b>, heading: &str, x: Axis, y: Axis) -> Drawn<Self> {
        let mut panel = Self::bare(area, heading, x, y)?;
        panel.grid()?;
        Ok(panel)
    }

    /// A panel without axes and grid, which are drawn over its regions with [`Self::grid`].
    pub fn bare(area: &'a Area<'b>, heading: &str, x: Axis, y: Axis) -> Drawn<Self> {
        let mut chart = ChartBuilder::on(area);
        let below = if x.name.is_empty() { NUMBERS } else { NUMBERS_AND_NAME };
        chart.margin(MARGIN).margin_right(MARGIN_RIGHT).margin_bottom(units(2));
        chart.x_label_area_size(below).y_label_area_size(BESIDE);
        if !heading.is_empty() {
            chart.margin_top(units(4)).caption(heading, text(LABEL));
        }
        let chart = chart.build_cartesian_2d(x.clone(), y.clone())?;
        let area = chart.plotting_area().strip_coord_spec();
        let (width, height) = area.dim_in_pixel();
        let frame = Frame { right: f64::from(width), bottom: f64::from(height) };
        Ok(Self { chart, x, y, area, frame })
    }

    pub fn grid(&mut self) -> Drawn<()> {
        let ticks = |size: f64, apart: i32| {
            ((size / f64::from(units(apart))) as usize).clamp(2, MOST_TICKS)
        };
        let mut mesh = self.chart.configure_mesh();
        mesh.bold_line_style(GRID.stroke_width(UNITS))
            .axis_style(BLACK.stroke_width(UNITS))
            .set_all_tick_mark_size(units(5))
            .x_labels(ticks(self.frame.right, TICKS_APART.0))
            .y_labels(ticks(self.frame.bottom, TICKS_APART.1))
            .y_desc(self.y.name)
            .label_style(text(LABEL));
        if !self.x.name.is_empty() {
            mesh.x_desc(self.x.name);
        }
        mesh.draw()
    }

    /// The place of a value in the drawing.
    pub fn place(&self, (x, y): (f64, f64)) -> Place {
        (self.x.part(x) * self.frame.right, (1.0 - self.y.part(y)) * self.frame.bottom)
    }

    /// The point of a value, in whole units.
    pub fn point(&self, value: (f64, f64)) -> (i32, i32) {
        whole(&self.place(value))
    }

    /// The place of a conjugate number.
    pub fn mirrored(&self, (x, y): Place) -> Place {
        (x, 2.0 * self.place((0.0, 0.0)).1 - y)
    }

    /// Whether a value is in the panel.
    pub fn holds(&self, (x, y): (f64, f64)) -> bool {
        self.x.holds(x) && self.y.holds(y)
    }

    /// Draws a line through places.
    pub fn line(&self, stroke: Stroke, places: &[Place]) -> Drawn<()> {
        stroke.draw(&self.area, &places.iter().map(whole).collect::<Vec<_>>())
    }

    /// Draws a line through values, as far as it is in the panel.
    pub fn curve(&self, stroke: Stroke, values: impl IntoIterator<Item = (f64, f64)>) -> Drawn<()> {
        let places: Vec<_> = values.into_iter().map(|value| self.place(value)).collect();
        let parts = self.frame.clip(&places);
        parts.iter().try_for_each(|part| self.line(stroke, part))
    }

    /// Draws a line across the panel at a height, if it is in the panel.
    pub fn level(&self, stroke: Stroke, y: f64) -> Drawn<()> {
        let y = self.place((f64::NAN, y)).1;
        self.curve_of_places(stroke, [(0.0, y), (self.frame.right, y)])
    }

    /// Draws a line from the bottom to the top of the panel, if it is in the panel.
    pub fn upright(&self, stroke: Stroke, x: f64) -> Drawn<()> {
        let x = self.place((x, f64::NAN)).0;
        self.curve_of_places(stroke, [(x, 0.0), (x, self.frame.bottom)])
    }

    fn curve_of_places(&self, stroke: Stroke, ends: [Place; 2]) -> Drawn<()> {
        if self.frame.contains(ends[0]) { self.line(stroke, &ends) } else { Ok(()) }
    }

    /// Fills the region between values with a colour, as far as it is in the panel.
    pub fn fill(&self, ink: RGBColor, corners: impl IntoIterator<Item = (f64, f64)>) -> Drawn<()> {
        let inside = |corner| whole(&self.frame.nearest(self.place(corner)));
        let corners: Vec<_> = corners.into_iter().map(inside).collect();
        self.area.draw(&Polygon::new(corners, ink.filled()))
    }

    /// Draws a mark at a value, if it is in the panel.
    pub fn mark(&self, mark: Mark, at: (f64, f64)) -> Drawn<()> {
        if self.holds(at) { mark.draw(&self.area, self.point(at)) } else { Ok(()) }
    }

    /// Draws an arrow head at a fraction of a line's length.
    pub fn arrow(&self, line: &[Place], part: f64) -> Drawn<()> {
        let length = |pair: &[Place]| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
        let mut left = part * line.windows(2).map(length).sum::<f64>();
        for pair in line.windows(2) {
            let length = length(pair);
            if length > 0.0 && left <= length {
                let along = ((pair[1].0 - pair[0].0) / length, (pair[1].1 - pair[0].1) / length);
                let tip = (pair[0].0 + along.0 * left, pair[0].1 + along.1 * left);
                return self.head(tip, along);
            }
            left -= length;
        }
        Ok(())
    }

    fn head(&self, tip: Place, along: Place) -> Drawn<()> {
        let [long, half] = [units(12), units(4)].map(f64::from);
        let corner = |side: f64| {
            whole(&(
                tip.0 - long * along.0 - side * half * along.1,
                tip.1 - long * along.1 + side * half * along.0,
            ))
        };
        let corners = vec![whole(&tip), corner(1.0), corner(-1.0)];
        self.area.draw(&Polygon::new(corners, BLACK.filled()))
    }
}
