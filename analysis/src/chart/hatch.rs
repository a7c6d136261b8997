//! Fill patterns that differ without colour, also at a width of one pixel.

use std::ops::Range;

use haptic_servo::torque::LimitReason;
use plotters::prelude::*;

use Direction::{Falling, Level, Rising, Upright};

use super::base::{Area, Drawn, UNITS, units};
use super::palette::{FAINT, FORBIDDEN};
use crate::simulation::tick_status::TickStatus;

/// Units between two lines of a hatching; all fills of a kind share one grid, so that adjacent narrow fills
/// also show it.
const SPACING: i32 = units(7);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    Solid(RGBColor),
    Lines(&'static [Direction]),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    Rising,
    Falling,
    Level,
    Upright,
}

impl Fill {
    /// The fill behind samples of this status, and its meaning; `None` for those whose torque was not
    /// limited.
    pub fn of(status: TickStatus) -> Option<(Self, &'static str)> {
        let lines = |directions, meaning| Some((Self::Lines(directions), meaning));
        match status {
            TickStatus::Ran(LimitReason::None) => None,
            TickStatus::Ran(LimitReason::Torque) => Some((Self::Solid(FORBIDDEN), "torque limit")),
            TickStatus::Ran(LimitReason::DacRange) => lines(&[Rising], "converter limit"),
            TickStatus::Ran(LimitReason::Angle) => lines(&[Falling], "angle out of range"),
            TickStatus::Ran(LimitReason::NotANumber) => lines(&[Rising, Falling], "not a number"),
            TickStatus::Ran(LimitReason::Ramp) => lines(&[Upright], "fading in or out"),
            TickStatus::Ran(LimitReason::Energy) => {
                lines(&[Rising, Upright], "host's energy spent")
            }
            TickStatus::Ran(LimitReason::Heat) => lines(&[Level, Upright], "heat limit"),
            TickStatus::Missed => lines(&[Level], "tick missed"),
        }
    }

    /// Covers a rectangle, in units of the area.
    pub(super) fn draw(self, area: &Area<'_>, x: &Range<i32>, y: &Range<i32>) -> Drawn<()> {
        match self {
            Self::Solid(ink) => {
                let corners = [(x.start, y.start), (x.end, y.end)];
                area.draw(&Rectangle::new(corners, ink.filled()))
            }
            Self::Lines(directions) => {
                let lines = directions.iter().flat_map(|direction| direction.lines(x, y));
                let path = |line: Line| PathElement::new(line, FAINT.stroke_width(UNITS));
                lines.map(path).try_for_each(|path| area.draw(&path))
            }
        }
    }
}

impl Direction {
    /// The lines as far as they lie in a rectangle.
    fn lines(self, x: &Range<i32>, y: &Range<i32>) -> Vec<Line> {
        match self {
            // `x + y` the same along each.
            Rising => {
                let sums = x.start + y.start..x.end + y.end;
                let line = |sum| {
                    let (from, to) = (x.start.max(sum - y.end), x.end.min(sum - y.start));
                    [(from, sum - from), (to, sum - to)]
                };
                on_grid(&sums).map(line).collect()
            }
            // `x - y` the same along each.
            Falling => {
                let mirrored = Rising.lines(x, &(-y.end..-y.start));
                mirrored.into_iter().map(|line| line.map(|(x, y)| (x, -y))).collect()
            }
            Level => on_grid(y).map(|level| [(x.start, level), (x.end, level)]).collect(),
            Upright => on_grid(x).map(|at| [(at, y.start), (at, y.end)]).collect(),
        }
    }
}

type Line = [(i32, i32); 2];

/// Multiples of the spacing in a range.
fn on_grid(range: &Range<i32>) -> impl Iterator<Item = i32> {
    let first = range.start.div_euclid(SPACING) * SPACING;
    (first..range.end).step_by(SPACING as usize).filter(|at| range.contains(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_in_their_rectangle_and_on_one_grid() {
        let (x, y) = (units(10)..units(11), units(3)..units(60));
        let [up, down] = [Rising, Falling].map(|direction| direction.lines(&x, &y));
        // A pixel wide and 57 high: a line every 7 pixels.
        assert!((8..=9).contains(&up.len()) && (8..=9).contains(&down.len()));
        for [from, to] in up.iter().chain(&down) {
            for (px, py) in [from, to] {
                assert!(x.start <= *px && *px <= x.end && y.start <= *py && *py <= y.end);
            }
        }
        for [from, to] in &up {
            assert_eq!((from.0 + from.1) % SPACING, 0);
            assert_eq!(to.0 + to.1, from.0 + from.1);
        }
        assert!(down.iter().all(|[from, to]| from.0 - from.1 == to.0 - to.1));
    }

    #[test]
    fn every_reason_has_a_fill_of_its_own() {
        let fills: Vec<_> = TickStatus::all().filter_map(Fill::of).map(|(fill, _)| fill).collect();
        assert_eq!(fills.len(), TickStatus::all().count() - 1);
        for (index, fill) in fills.iter().enumerate() {
            assert!(!fills[..index].contains(fill));
        }
    }
}
