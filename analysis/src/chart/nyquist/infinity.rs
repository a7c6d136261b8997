//! The closure of a curve at infinity, at a pole on the unit circle (equation 4).
//!
//! Around a pole `z0` the contour makes half a turn outside the circle, and the curve, which is
//! `k / (z/z0 - 1)` there, half a turn clockwise at infinity: through the right half-plane if the residue `k`
//! is positive, through the left if it is negative. The chart's frame stands for infinity.

use super::Curve;
use crate::chart::frame::{Frame, Place};
use crate::chart::panel::Panel;
use crate::chart::stroke::Stroke;
use crate::chart::{Drawn, units};
use crate::nyquist::Branch;
use crate::unit_circle_poles::UnitCirclePole;

/// The line style of a closure at infinity.
pub(super) const FAR: Stroke = Stroke::dashed(&[4, 4], 1);

/// Room around the outermost frame, in units of the drawing.
const ROOM: i32 = units(10);
/// Distance between the frames of two poles.
const STEP: i32 = units(7);

/// The frame of each pole of each curve, later frames inside earlier ones.
pub(super) fn frames(panel: &Panel<'_, '_>, curves: &[&Curve]) -> Vec<Vec<Frame>> {
    let all = panel.frame;
    let mut level = 0;
    let mut frame = |_: &UnitCirclePole| {
        let room = f64::from(ROOM + STEP * level);
        level += 1;
        Frame {
            left: all.left + room,
            top: all.top + room,
            right: all.right - room,
            bottom: all.bottom - room,
        }
    };
    curves.iter().map(|curve| curve.poles.iter().map(&mut frame).collect()).collect()
}

/// Draws the closures of one curve at infinity, and returns them.
pub(super) fn draw(
    panel: &Panel<'_, '_>,
    curve: &Curve,
    frames: &[Frame],
) -> Drawn<Vec<Vec<Place>>> {
    let drawn = (0..curve.poles.len()).filter(|&pole| curve.poles[pole].is_simple());
    let way = |pole: usize| {
        let (from, to) = ends(panel, curve, pole, &frames[pole])?;
        Some(around(&frames[pole], from, to))
    };
    let ways: Vec<_> = drawn.filter_map(way).collect();
    for way in &ways {
        panel.line(FAR, way)?;
        panel.arrow(way, 0.62)?;
    }
    Ok(ways)
}

/// The ends of the curve at a pole, where it goes to infinity and where it returns, with rising angle. At the
/// pole's conjugate the closure is the same if the residue is real; otherwise it is mirrored and not drawn.
fn ends(
    panel: &Panel<'_, '_>,
    curve: &Curve,
    pole: usize,
    frame: &Frame,
) -> Option<(Place, Place)> {
    let branch = |end: usize| curve.branches.iter().find(|b| b.poles[end] == Some(pole));
    let places = |b: &'_ Branch| b.values.iter().map(|&v| panel.place(v)).collect::<Vec<_>>();
    let from = branch(1).map(places).map(|line| frame.exit(line.into_iter()));
    let to = branch(0).map(places).map(|line| frame.exit(line.into_iter().rev()));
    // At rest and at half the sample rate the other end is the mirrored one.
    let mirrored = |end: Option<Place>| end.map(|end| frame.nearest(panel.mirrored(end)));
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

/// Along the frame clockwise.
fn around(frame: &Frame, from: Place, to: Place) -> Vec<Place> {
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
    points
}

/// Length of the frame clockwise from its upper left corner to a place on it.
fn way_to(frame: &Frame, (x, y): Place) -> f64 {
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
