//! The torque on a hand that turns a torque profile: over angle, and with the angle over time.

use std::collections::HashSet;

use super::profile::{draw_slopes, slopes};
use super::*;
use crate::felt_turn::FeltTurn;

/// Heights of the panels in pixels.
const PANELS: [i32; 3] = [290, 180, 200];
/// The lines of the profile, of the motion and of the hand's set-point.
const PROFILE: Stroke = Stroke::solid(1);
const MOTION: Stroke = Stroke::solid(2);
const HAND: Stroke = Stroke::dashed(&[6, 4], 1);

pub fn turn(title: &str, turn: &FeltTurn) -> Result<Picture, ChartError> {
    let dots = "torque of the servo's codes, a dot each tick".to_owned();
    let hand = (Sample::Line(HAND), "set-point of the hand".to_owned());
    let entries = [(Sample::Point(Mark::FAINT), dots)].into_iter();
    let entries = entries.chain(slopes(&turn.curve)).chain([hand]);
    Page::new(title, &PANELS).legend(1, entries).draw(|areas| {
        over_angle(&areas[0], turn)?;
        let angles = [(HAND, &turn.setpoint[..]), (MOTION, &turn.angle)];
        over_time(&areas[1], &turn.time, &angles, ["", "angle (rad)"])?;
        over_time(&areas[2], &turn.time, &[(MOTION, &turn.torque)], ["time (s)", "torque (N m)"])
    })
}

/// The profile with its slopes, over the torques of the ticks.
fn over_angle(area: &Area<'_>, turn: &FeltTurn) -> Drawn<()> {
    let curve = &turn.curve;
    let x = span(curve.points.iter().map(|point| point[0]));
    let torques = curve.points.iter().map(|point| point[1]).chain(turn.torque.iter().copied());
    let y = padded(span(torques), 0.2);
    let axes = (Axis::linear(x.clone(), "angle (rad)"), Axis::linear(y.clone(), "torque (N m)"));
    let panel = Panel::new(area, axes.0, axes.1)?;
    panel.level(PROFILE, 0.0)?;
    // One dot per pixel.
    let mut drawn = HashSet::new();
    for tick in turn.angle.iter().copied().zip(turn.torque.iter().copied()) {
        let (x, y) = panel.point(tick);
        if drawn.insert((x / units(1), y / units(1))) {
            panel.mark(Mark::FAINT, tick)?;
        }
    }
    panel.curve(PROFILE, curve.points.iter().map(|point| (point[0], point[1])))?;
    draw_slopes(&panel, curve, &x, &y)
}

fn over_time(
    area: &Area<'_>,
    time: &[f64],
    lines: &[(Stroke, &[f64])],
    [x_name, y_name]: [&'static str; 2],
) -> Drawn<()> {
    let end = time.last().copied().unwrap_or(1.0);
    let y = padded(span(lines.iter().flat_map(|line| line.1).copied()), 0.12);
    let panel = Panel::new(area, Axis::linear(0.0..end, x_name), Axis::linear(y, y_name))?;
    lines.iter().try_for_each(|(stroke, values)| {
        panel.curve(*stroke, time.iter().copied().zip(values.iter().copied()))
    })
}
