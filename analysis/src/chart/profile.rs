//! A torque profile: torque and potential over angle, the steepest pieces, the steepest slope that certifies,
//! and the torque over the angle of the handle.

use super::*;
use crate::profile_curve::{Piece, ProfileCurve};
use crate::quantity::significant;
use crate::snap_branches::Branch;

/// Heights of the two panels in pixels.
const PANELS: [i32; 2] = [300, 240];
/// Largest extent of the line of the certified slope, relative to the chart's width and height.
const REACH: f64 = 0.2;
/// The lines of torque and potential, of the steepest pieces, of the steepest slope that certifies, of the
/// torque limit, of a detent that snaps, and of the torque that is felt.
const CURVE: Stroke = Stroke::solid(1);
const STEEPEST: Stroke = Stroke::solid(4);
const CERTIFIED: Stroke = Stroke::dashed(&[9, 5], 2);
const LIMIT: Stroke = Stroke::dashed(&[12, 4, 2, 4], 1);
const SNAP: Stroke = Stroke::dashed(&[2, 4], 1);
const FELT: Stroke = Stroke::dashed(&[6, 3], 1);

/// Draws a profile. `limit`: the torque limit in N m.
pub fn profile(
    title: &str,
    curve: &ProfileCurve,
    limit: Option<f64>,
) -> Result<Picture, ChartError> {
    let mut entries = slopes(curve);
    if !curve.branches.is_empty() {
        let words = "a detent snaps to the next one, from the dot on".to_owned();
        entries.push((Sample::Line(SNAP), words));
    }
    if curve.compliance > 0.0 {
        let felt = curve.rise.slope / (1.0 + curve.compliance * curve.rise.slope);
        let words =
            format!("at the handle, behind the coupling: up to {} N m/rad", significant(felt, 4));
        entries.push((Sample::Line(FELT), words));
    }
    if let Some(limit) = limit {
        let words = format!("torque limit, {} N m", significant(limit, 4));
        entries.push((Sample::Line(LIMIT), words));
    }
    Page::new(title, &PANELS).legend(1, entries).draw(|areas| {
        torque(&areas[0], curve, limit)?;
        let millijoules = || curve.points.iter().map(|point| (point[0], 1e3 * point[2]));
        let x = Axis::linear(angles(curve), "angle (rad)");
        let y = padded(span(millijoules().map(|point| point.1)), 0.08);
        let panel = Panel::new(&areas[1], x, Axis::linear(y, "potential (mJ)"))?;
        panel.curve(CURVE, millijoules())
    })
}

fn angles(curve: &ProfileCurve) -> Range<f64> {
    padded(span(curve.points.iter().map(|point| point[0])), 0.02)
}

fn torque(area: &Area<'_>, curve: &ProfileCurve, limit: Option<f64>) -> Drawn<()> {
    let x = angles(curve);
    let of_branches = curve.branches.iter().flat_map(|branch| &branch.points);
    let own = curve.points.iter().map(|p| p[1]).chain(of_branches.map(|p| p[1]));
    let y = padded(span(own), 0.12);
    let axes = (Axis::linear(x.clone(), ""), Axis::linear(y.clone(), "torque (N m)"));
    let panel = Panel::new(area, axes.0, axes.1)?;
    panel.level(CURVE, 0.0)?;
    for limit in limit.into_iter().flat_map(|limit| [-limit, limit]) {
        panel.level(LIMIT, limit)?;
    }
    let is_felt = curve.compliance > 0.0;
    let felt = |&[angle, torque]: &[f64; 2]| (curve.at_handle(angle, torque), torque);
    if curve.branches.is_empty() {
        panel.curve(CURVE, curve.points.iter().map(|point| (point[0], point[1])))?;
        let felt = curve.points.iter().map(|[angle, torque, _]| felt(&[*angle, *torque]));
        if is_felt {
            panel.curve(FELT, felt)?;
        }
    }
    for Branch { points, snaps } in &curve.branches {
        if is_felt {
            panel.curve(FELT, points.iter().map(felt))?;
        }
        panel.curve(CURVE, points.iter().map(|point| (point[0], point[1])))?;
        for &[angle, before, after] in snaps {
            panel.curve(SNAP, [(angle, before), (angle, after)])?;
            panel.mark(Mark::DOT, (angle, before))?;
        }
    }
    draw_slopes(&panel, curve, &x, &y)
}

/// The steepest pieces, and the steepest rise that certifies.
pub(super) fn draw_slopes(
    panel: &Panel<'_, '_>,
    curve: &ProfileCurve,
    x: &Range<f64>,
    y: &Range<f64>,
) -> Drawn<()> {
    for piece in [curve.rise, curve.fall] {
        let half = 0.5 * piece.width;
        let ends = [-half, half].map(|by| (piece.angle + by, piece.torque + by * piece.slope));
        panel.line(STEEPEST, &ends.map(|end| panel.frame.nearest(panel.place(end))))?;
    }
    match curve.certified {
        Some(slope) => panel.curve(CERTIFIED, certified(&curve.rise, slope, x, y)),
        None => Ok(()),
    }
}

/// A line of the certified slope through the middle of the steepest rise, inside the chart.
fn certified(rise: &Piece, slope: f64, x: &Range<f64>, y: &Range<f64>) -> [(f64, f64); 2] {
    let room = (y.end - rise.torque).min(rise.torque - y.start).max(0.0);
    let wide = (REACH * (x.end - x.start)).min(x.end - rise.angle).min(rise.angle - x.start);
    let half = wide.min(room / slope);
    [-half, half].map(|by| (rise.angle + by, rise.torque + by * slope))
}

pub(super) fn slopes(curve: &ProfileCurve) -> Vec<(Sample, String)> {
    let slope = |value: f64| significant(value, 4);
    let steepest = format!(
        "steepest rise, {} N m/rad, and steepest fall, {} N m/rad",
        slope(curve.rise.slope),
        slope(curve.fall.slope)
    );
    let bound = curve.certified.map_or_else(
        || (Sample::Nothing, "no rise certifies".to_owned()),
        |bound| {
            let words = format!("steepest rise that certifies, {} N m/rad", slope(bound));
            (Sample::Line(CERTIFIED), words)
        },
    );
    vec![(Sample::Line(STEEPEST), steepest), bound]
}
