//! Lines: dash patterns that differ without colour, a width and an ink.

use plotters::prelude::*;

use super::base::{Area, Drawn, UNITS, units};
use super::palette::FAINT;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stroke {
    /// Ink and gap in pixels, alternately; empty for a solid line.
    dash: &'static [i32],
    /// In pixels.
    width: u32,
    ink: RGBColor,
}

/// The patterns in the order in which a picture uses them.
const PATTERNS: [&[i32]; 6] =
    [&[], &[11, 5], &[2, 4], &[12, 4, 2, 4], &[6, 3], &[12, 4, 2, 4, 2, 4]];

impl Stroke {
    /// Unbroken, with a width in pixels.
    pub const fn solid(width: u32) -> Self {
        Self::dashed(&[], width)
    }

    /// A pattern of pixels of ink, pixels of gap, and so on.
    pub const fn dashed(dash: &'static [i32], width: u32) -> Self {
        Self { dash, width, ink: BLACK }
    }

    /// The stroke of the curve with this number; the patterns repeat.
    pub const fn of(index: usize, width: u32) -> Self {
        Self::dashed(PATTERNS[index % PATTERNS.len()], width)
    }

    pub const fn ink(self, ink: RGBColor) -> Self {
        Self { ink, ..self }
    }

    pub const fn faint(self) -> Self {
        self.ink(FAINT)
    }

    pub const fn wide(self, width: u32) -> Self {
        Self { width, ..self }
    }

    /// The parts of a line with ink, as separate lines. The points are in units of the drawing, so that the
    /// pattern is even at any slope.
    fn split(self, points: &[(i32, i32)]) -> Vec<Vec<(i32, i32)>> {
        if self.dash.is_empty() {
            return vec![points.to_vec()];
        }
        let mut parts: Vec<Vec<(i32, i32)>> = Vec::new();
        let (mut index, mut left, mut open) = (0, f64::from(units(self.dash[0])), false);
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|(x, y)| (f64::from(x), f64::from(y)));
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            let mut done = 0.0;
            while done < length {
                let step = left.min(length - done);
                let at = |s: f64| {
                    let part = s / length;
                    let x = from.0 + part * (to.0 - from.0);
                    (x.round() as i32, (from.1 + part * (to.1 - from.1)).round() as i32)
                };
                if index % 2 == 0 {
                    if !open {
                        parts.push(vec![at(done)]);
                        open = true;
                    }
                    if let Some(part) = parts.last_mut() {
                        part.push(at(done + step));
                    }
                }
                done += step;
                left -= step;
                if left <= 0.0 {
                    index = (index + 1) % self.dash.len();
                    left = f64::from(units(self.dash[index]));
                    open = false;
                }
            }
        }
        parts
    }

    /// Draws a line through points in units of the drawing.
    pub(super) fn draw(self, area: &Area<'_>, points: &[(i32, i32)]) -> Drawn<()> {
        let style = self.ink.stroke_width(self.width * UNITS);
        self.split(points)
            .into_iter()
            .try_for_each(|part| area.draw(&PathElement::new(part, style)))
    }
}
