//! The plot area of a chart in units of the drawing, and clipping of lines to a frame.

use plotters::prelude::*;

use crate::chart::dash::Dash;
use crate::chart::{Area, Drawn, Plane, pen, units};

/// A point in units of the drawing, from the upper left corner of the plot.
pub(super) type DrawingPoint = (f64, f64);

/// The plot: real parts to the right, imaginary parts upwards.
pub(super) struct PlotArea<'a> {
    pub(super) area: Area<'a>,
    x: (f64, f64),
    y: (f64, f64),
    size: DrawingPoint,
}

impl<'a> PlotArea<'a> {
    pub(super) fn of(chart: &Plane<'_, 'a>) -> Self {
        let plot = chart.plotting_area();
        let (x, y) = (plot.get_x_range(), plot.get_y_range());
        let (width, height) = plot.dim_in_pixel();
        Self {
            area: plot.strip_coord_spec(),
            x: (x.start, x.end),
            y: (y.start, y.end),
            size: (f64::from(width), f64::from(height)),
        }
    }

    /// The place of a value in the drawing.
    pub(super) fn place(&self, (re, im): (f64, f64)) -> DrawingPoint {
        let part = |value: f64, (from, to): (f64, f64)| (value - from) / (to - from);
        (part(re, self.x) * self.size.0, (1.0 - part(im, self.y)) * self.size.1)
    }

    /// The place of its conjugate.
    pub(super) fn mirrored(&self, (x, y): DrawingPoint) -> DrawingPoint {
        (x, 2.0 * self.place((0.0, 0.0)).1 - y)
    }

    /// The whole of it.
    pub(super) fn all(&self) -> Frame {
        Frame { left: 0.0, top: 0.0, right: self.size.0, bottom: self.size.1 }
    }

    /// Draws a line with a width in pixels.
    pub(super) fn line(&self, dash: Dash, places: &[DrawingPoint], width: u32) -> Drawn<()> {
        self.line_in(dash, places, pen(width))
    }

    /// Draws a line of another style than black.
    pub(super) fn line_in(
        &self,
        dash: Dash,
        places: &[DrawingPoint],
        style: ShapeStyle,
    ) -> Drawn<()> {
        let points: Vec<_> = places.iter().map(whole).collect();
        dash.draw_styled(&self.area, &points, style)
    }

    /// Draws an arrow head at a fraction of a line's length.
    pub(super) fn arrow(&self, line: &[DrawingPoint], part: f64) -> Drawn<()> {
        let lengths = line.windows(2).map(|pair| distance(pair[0], pair[1]));
        let mut left = part * lengths.clone().sum::<f64>();
        for (pair, length) in line.windows(2).zip(lengths) {
            if length > 0.0 && left <= length {
                let along = ((pair[1].0 - pair[0].0) / length, (pair[1].1 - pair[0].1) / length);
                let tip = (pair[0].0 + along.0 * left, pair[0].1 + along.1 * left);
                return self.head(tip, along);
            }
            left -= length;
        }
        Ok(())
    }

    fn head(&self, tip: DrawingPoint, along: DrawingPoint) -> Drawn<()> {
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

pub(super) fn whole(place: &DrawingPoint) -> (i32, i32) {
    (place.0.round() as i32, place.1.round() as i32)
}

fn distance(a: DrawingPoint, b: DrawingPoint) -> f64 {
    (b.0 - a.0).hypot(b.1 - a.1)
}

/// A rectangle; down is positive, as in the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Frame {
    /// Whether a place is inside or on the border; never true of NaN.
    pub(super) fn contains(&self, (x, y): DrawingPoint) -> bool {
        self.left <= x && x <= self.right && self.top <= y && y <= self.bottom
    }

    /// The nearest place inside or on the border.
    pub(super) fn nearest(&self, (x, y): DrawingPoint) -> DrawingPoint {
        (x.clamp(self.left, self.right), y.clamp(self.top, self.bottom))
    }

    /// The point in which the line from an inner to an outer place crosses the border.
    pub(super) fn crossing(&self, inner: DrawingPoint, outer: DrawingPoint) -> DrawingPoint {
        let part = |from: f64, to: f64, low: f64, high: f64| {
            let bound = if to > from { high } else { low };
            if to == from { f64::INFINITY } else { (bound - from) / (to - from) }
        };
        let t = part(inner.0, outer.0, self.left, self.right)
            .min(part(inner.1, outer.1, self.top, self.bottom))
            .clamp(0.0, 1.0);
        let x = inner.0 + t * (outer.0 - inner.0);
        let y = inner.1 + t * (outer.1 - inner.1);
        self.nearest((x, y))
    }

    /// The last point in which a line leaves the frame; `None` if it ends inside, or is never inside.
    pub(super) fn exit(
        &self,
        line: impl DoubleEndedIterator<Item = DrawingPoint>,
    ) -> Option<DrawingPoint> {
        let mut outer = None;
        for place in line.rev().filter(|place| place.0.is_finite() && place.1.is_finite()) {
            if self.contains(place) {
                return outer.map(|outer| self.crossing(place, outer));
            }
            outer = Some(place);
        }
        None
    }

    /// The parts of a line inside, up to the border; `frame` gives the frame of each place by its number.
    pub(super) fn clip(
        line: &[DrawingPoint],
        frame: impl Fn(usize) -> Self,
    ) -> Vec<Vec<DrawingPoint>> {
        let mut parts: Vec<Vec<DrawingPoint>> = Vec::new();
        let mut open = false;
        for (i, &place) in line.iter().enumerate() {
            let inside = frame(i).contains(place);
            let before = i.checked_sub(1).map(|j| line[j]).filter(|p| p.0.is_finite());
            match (open, inside) {
                (false, true) => {
                    let entry = before.map(|before| frame(i).crossing(place, before));
                    parts.push(entry.into_iter().chain([place]).collect());
                }
                (true, _) => {
                    if let (Some(part), Some(before)) = (parts.last_mut(), before) {
                        let end = if inside { place } else { frame(i).crossing(before, place) };
                        part.extend([end].into_iter().filter(|end| end.0.is_finite()));
                    }
                }
                (false, false) => {}
            }
            open = inside;
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 1.0, top: 2.0, right: 9.0, bottom: 8.0 };

    #[test]
    fn lines_end_on_the_border() {
        let line = [(5.0, -4.0), (5.0, 5.0), (7.0, 5.0), (11.0, 7.0), (f64::NAN, f64::INFINITY)];
        let parts = Frame::clip(&line, |_| FRAME);
        assert_eq!(parts, [[(5.0, 2.0), (5.0, 5.0), (7.0, 5.0), (9.0, 6.0)]]);
        assert_eq!(FRAME.exit(line.into_iter()), Some((9.0, 6.0)));
        assert_eq!(FRAME.exit(line.into_iter().rev()), Some((5.0, 2.0)));
        assert_eq!(FRAME.exit(line[..2].iter().copied()), None);
    }
}
