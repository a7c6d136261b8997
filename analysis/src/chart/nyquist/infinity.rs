//! The closure of a curve at infinity, at a pole on the unit circle (equation 4).
//!
//! Around a pole `z0` the contour makes half a turn outside the circle, and the curve, which is
//! `k / (z/z0 - 1)` there, half a turn clockwise at infinity: through the right half-plane if the residue `k`
//! is positive, through the left if it is negative. The chart's frame stands for infinity.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::Curve;
use crate::chart::dash::Dash;
use crate::chart::plot_area::{DrawingPoint, Frame, PlotArea};
use crate::chart::{Drawn, anchored, units};
use crate::nyquist::Branch;
use crate::unit_circle_poles::UnitCirclePole;

/// The line style of a closure at infinity.
const FAR: Dash = Dash::new(&[4, 4]);

/// Room at the left and right for words outside of the frames, in units of the drawing.
const WORDS: i32 = units(24);
/// Room above and below the outermost frame.
const ROOM: i32 = units(10);
/// Distance between the frames of two poles.
const STEP: i32 = units(7);
/// Radius of a frame's corners.
const CORNER: f64 = units(14) as f64;

/// The frame of each pole of each curve, later frames inside earlier ones.
pub(super) fn frames(plot: &PlotArea<'_>, curves: &[&Curve]) -> Vec<Vec<Frame>> {
    let all = plot.all();
    let mut level = 0;
    let mut frame = |_: &UnitCirclePole| {
        let [side, above] = [WORDS, ROOM].map(|room| f64::from(room + STEP * level));
        level += 1;
        Frame {
            left: all.left + side,
            top: all.top + above,
            right: all.right - side,
            bottom: all.bottom - above,
        }
    };
    curves.iter().map(|curve| curve.poles.iter().map(&mut frame).collect()).collect()
}

/// Draws the closures of one curve at infinity, and returns them.
pub(super) fn draw(
    plot: &PlotArea<'_>,
    curve: &Curve,
    frames: &[Frame],
) -> Drawn<Vec<Vec<DrawingPoint>>> {
    let drawn = (0..curve.poles.len()).filter(|&pole| curve.poles[pole].is_simple());
    let way = |pole: usize| {
        let (from, to) = ends(plot, curve, pole, &frames[pole])?;
        Some(around(&frames[pole], from, to))
    };
    let ways: Vec<_> = drawn.filter_map(way).collect();
    for way in &ways {
        plot.line(FAR, way, 1)?;
        plot.arrow(way, 0.62)?;
    }
    Ok(ways)
}

/// The ends of the curve at a pole, where it goes to infinity and where it returns, with rising angle. At the
/// pole's conjugate the closure is the same if the residue is real; otherwise it is mirrored and not drawn.
fn ends(
    plot: &PlotArea<'_>,
    curve: &Curve,
    pole: usize,
    frame: &Frame,
) -> Option<(DrawingPoint, DrawingPoint)> {
    let branch = |end: usize| curve.branches.iter().find(|b| b.poles[end] == Some(pole));
    let places = |b: &'_ Branch| b.values.iter().map(|&v| plot.place(v)).collect::<Vec<_>>();
    let from = branch(1).map(places).map(|line| frame.exit(line.into_iter()));
    let to = branch(0).map(places).map(|line| frame.exit(line.into_iter().rev()));
    // At rest and at half the sample rate the other end is the mirrored one.
    let mirrored = |end: Option<DrawingPoint>| end.map(|end| frame.nearest(plot.mirrored(end)));
    let (from, to) = match (from, to) {
        (None, None) => return None,
        (Some(from), None) => (from?, mirrored(from)?),
        (None, Some(to)) => (mirrored(to)?, to?),
        (Some(from), Some(to)) => (from?, to?),
    };
    Some(match curve.poles[pole].residue() {
        None => (from, to),
        // One line for both: from the end that it meets last when seen from the side it takes.
        Some(k) => {
            let x = if k > 0.0 { from.0.min(to.0) } else { from.0.max(to.0) };
            ((x, from.1), (x, to.1))
        }
    })
}

/// Along the frame clockwise, with rounded corners.
fn around(frame: &Frame, from: DrawingPoint, to: DrawingPoint) -> Vec<DrawingPoint> {
    let [start, mut end] = [from, to].map(|place| way_to(frame, place));
    let (width, height) = (frame.right - frame.left, frame.bottom - frame.top);
    let once = 2.0 * (width + height);
    if end <= start {
        end += once;
    }
    let corners = [
        (width, (frame.right, frame.top)),
        (width + height, (frame.right, frame.bottom)),
        (2.0 * width + height, (frame.left, frame.bottom)),
        (once, (frame.left, frame.top)),
    ];
    let turns = [0.0, once].into_iter().flat_map(|turn| corners.map(|(s, at)| (s + turn, at)));
    let mut points = vec![from];
    points.extend(turns.filter(|(s, _)| start < *s && *s < end).map(|(_, corner)| corner));
    points.push(to);
    rounded(&points)
}

/// Length of the frame clockwise from its upper left corner to a place on it.
fn way_to(frame: &Frame, (x, y): DrawingPoint) -> f64 {
    let (width, height) = (frame.right - frame.left, frame.bottom - frame.top);
    let sides = [
        (y - frame.top, x - frame.left),
        (frame.right - x, width + y - frame.top),
        (frame.bottom - y, width + height + frame.right - x),
        (x - frame.left, 2.0 * width + height + frame.bottom - y),
    ];
    let nearest = sides.into_iter().min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    nearest.map_or(0.0, |(_, way)| way)
}

/// The line with its corners rounded, as far as their neighbours leave room.
fn rounded(points: &[DrawingPoint]) -> Vec<DrawingPoint> {
    let mut line = vec![points[0]];
    for three in points.windows(3) {
        let [before, corner, after] = [three[0], three[1], three[2]];
        let towards = |other: DrawingPoint| {
            let length = (other.0 - corner.0).hypot(other.1 - corner.1);
            let part = if length > 0.0 { (CORNER / length).min(0.5) } else { 0.0 };
            (corner.0 + part * (other.0 - corner.0), corner.1 + part * (other.1 - corner.1))
        };
        let (a, b) = (towards(before), towards(after));
        let bend = |t: f64| {
            let mix = |a: f64, c: f64, b: f64| {
                (1.0 - t) * (1.0 - t) * a + 2.0 * t * (1.0 - t) * c + t * t * b
            };
            (mix(a.0, corner.0, b.0), mix(a.1, corner.1, b.1))
        };
        line.extend((0..=8).map(|i| bend(f64::from(i) / 8.0)));
    }
    line.push(points[points.len() - 1]);
    line
}

/// Names the ways, once, at a side that one of them takes, above the real axis.
pub(super) fn name(plot: &PlotArea<'_>, ways: &[Vec<DrawingPoint>]) -> Drawn<()> {
    let all = plot.all();
    let passes = |far: bool| {
        let near = |x: f64| if far { x > 0.8 * all.right } else { x < 0.2 * all.right };
        let tall = |way: &&Vec<DrawingPoint>| {
            way.windows(2).any(|p| near(p[0].0) && (p[1].1 - p[0].1).abs() > 0.5 * all.bottom)
        };
        ways.iter().any(|way| tall(&way))
    };
    if ways.is_empty() {
        return Ok(());
    }
    let side = if passes(true) || !passes(false) { all.right } else { all.left };
    let inwards = if side > 0.0 { -WORDS / 2 } else { WORDS / 2 };
    let place = (side.round() as i32 + inwards, (0.3 * all.bottom).round() as i32);
    let style = anchored(HPos::Center, VPos::Center).transform(FontTransform::Rotate90);
    plot.area.draw(&Text::new("at infinity", place, style))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 100.0, top: 50.0, right: 1900.0, bottom: 1050.0 };

    #[test]
    fn ways_are_clockwise() {
        // From above to below: through the right half-plane.
        let right = around(&FRAME, (700.0, 50.0), (700.0, 1050.0));
        assert!(right.iter().all(|place| place.0 >= 700.0));
        assert!(right.iter().any(|place| place.0 == 1900.0));
        // From below to above: through the left one.
        let left = around(&FRAME, (700.0, 1050.0), (700.0, 50.0));
        assert!(left.iter().all(|place| place.0 <= 700.0));
        assert!(left.iter().any(|place| place.0 == 100.0));
        // From left to right: above, over the beginning of the border's length.
        let above = around(&FRAME, (100.0, 600.0), (1900.0, 600.0));
        assert!(above.iter().all(|place| place.1 <= 600.0));
        for way in [right, left, above] {
            assert!(way.iter().all(|place| FRAME.contains(*place)));
        }
    }
}
