//! Dash patterns that differ without colour.

use plotters::prelude::*;

use super::{UNITS, units};

/// Ink and gap in pixels, alternately; empty for a solid line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dash(&'static [i32]);

/// Unbroken.
pub const SOLID: Dash = Dash(&[]);

/// The patterns in the order in which a picture uses them.
const PATTERNS: [Dash; 6] = [
    SOLID,
    Dash(&[11, 5]),
    Dash(&[2, 4]),
    Dash(&[12, 4, 2, 4]),
    Dash(&[6, 3]),
    Dash(&[12, 4, 2, 4, 2, 4]),
];

impl Dash {
    /// A pattern from pixels of ink, pixels of gap, and so on.
    pub(super) const fn new(pattern: &'static [i32]) -> Self {
        Self(pattern)
    }

    /// The pattern of the curve with this number; the patterns repeat.
    pub fn of(index: usize) -> Self {
        PATTERNS[index % PATTERNS.len()]
    }

    /// The parts of a line with ink, as separate lines. The points are in units of the drawing, so that the
    /// pattern is even at any slope.
    pub fn split(self, points: &[(i32, i32)]) -> Vec<Vec<(i32, i32)>> {
        if self.0.is_empty() {
            return vec![points.to_vec()];
        }
        let mut parts: Vec<Vec<(i32, i32)>> = Vec::new();
        let (mut index, mut left, mut open) = (0, f64::from(units(self.0[0])), false);
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
                    index = (index + 1) % self.0.len();
                    left = f64::from(units(self.0[index]));
                    open = false;
                }
            }
        }
        parts
    }

    /// Draws a line through points in units of the drawing, with a width in pixels.
    pub(super) fn draw(
        self,
        area: &super::Area<'_>,
        points: &[(i32, i32)],
        width: u32,
    ) -> super::Drawn<()> {
        self.draw_styled(area, points, BLACK.stroke_width(width * UNITS))
    }

    /// Draws a line of another style than black.
    pub(super) fn draw_styled(
        self,
        area: &super::Area<'_>,
        points: &[(i32, i32)],
        style: ShapeStyle,
    ) -> super::Drawn<()> {
        for part in self.split(points) {
            area.draw(&PathElement::new(part, style))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ink_and_gap_have_their_lengths_around_corners() {
        let line = [(0, 0), (units(8), 0), (units(8), units(20))];
        let parts = Dash::of(1).split(&line);
        assert_eq!(parts[0], [(0, 0), (units(8), 0), (units(8), units(3))]);
        assert_eq!(parts[1], [(units(8), units(8)), (units(8), units(19))]);
        assert_eq!(SOLID.split(&line), [line.to_vec()]);
    }
}
