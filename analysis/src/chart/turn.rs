//! The torque on a hand that turns a torque profile: over angle, and with the angle over time.

use std::collections::HashSet;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::{Dash, SOLID};
use super::profile::{draw_certified, draw_pieces, legend};
use super::*;
use crate::felt_turn::FeltTurn;

/// Heights of the panels in pixels.
const PANELS: [i32; 3] = [290, 170, 190];
/// Height of a line of the legend in pixels.
const ROW: i32 = 22;
/// The line style of the hand's set-point.
const HAND: Dash = Dash::new(&[6, 4]);
/// Radius in pixels of a tick's torque.
const DOT: i32 = 2;

/// Draws a turn.
///
/// # Errors
/// If the drawing fails.
pub fn turn(title: &str, turn: &FeltTurn) -> Result<Picture, ChartError> {
    let slopes = legend(&turn.curve, None);
    let rows = slopes.len() as i32 + 2;
    let height = TITLE_ROOM + PANELS.iter().sum::<i32>() + ROW * rows + 12;
    draw_sized((SIZE.0, height as u32), |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(title, text(TITLE))?;
        let (first, area) = area.split_vertically(units(PANELS[0]));
        let (second, area) = area.split_vertically(units(PANELS[1]));
        let (third, words) = area.split_vertically(units(PANELS[2]));
        over_angle(&first, turn)?;
        let setpoint = Some(turn.setpoint.as_slice());
        over_time(&second, turn, &turn.angle, setpoint, (None, "angle (rad)"))?;
        over_time(&third, turn, &turn.torque, None, (Some("time (s)"), "torque (N m)"))?;
        let dots = "torque of the servo's codes, a dot each tick";
        write_row(&words, 0, dots, |at| {
            (0..9).try_for_each(|dot| words.draw(&dot_at((at.0 + units(2 + 7 * dot), at.1))))
        })?;
        for (row, (dash, width, line)) in slopes.iter().enumerate() {
            write_row(&words, row as i32 + 1, line, |at| {
                dash.draw(&words, &[at, (at.0 + units(60), at.1)], *width)
            })?;
        }
        write_row(&words, rows - 1, "set-point of the hand", |at| {
            HAND.draw(&words, &[at, (at.0 + units(60), at.1)], 1)
        })
    })
}

fn write_row(
    area: &Area<'_>,
    row: i32,
    words: &str,
    sample: impl Fn((i32, i32)) -> Drawn<()>,
) -> Drawn<()> {
    let y = units(ROW * row + ROW / 2);
    sample((units(30), y))?;
    let style = anchored(HPos::Left, VPos::Center);
    area.draw(&Text::new(words.to_owned(), (units(102), y), style))
}

fn dot_at(at: (i32, i32)) -> Circle<(i32, i32), i32> {
    Circle::new(at, units(DOT), FAINT.filled())
}

/// The profile with its slopes, over the torques of the ticks.
fn over_angle(area: &Area<'_>, turn: &FeltTurn) -> Drawn<()> {
    let curve = &turn.curve;
    let x = span(curve.points.iter().map(|point| point[0]));
    let torques = curve.points.iter().map(|point| point[1]).chain(turn.torque.iter().copied());
    let y = padded(span(torques), 0.2);
    let mut chart =
        axes::chart(area).margin_right(MARGIN_RIGHT).build_cartesian_2d(x.clone(), y.clone())?;
    let names = Axes::named("angle (rad)", "torque (N m)");
    Axes { most: (11, 8), ..names }.draw(&mut chart)?;
    chart.draw_series([PathElement::new([(x.start, 0.0), (x.end, 0.0)], pen(1))])?;
    draw_dots(&chart, turn)?;
    let line = curve.points.iter().map(|point| (point[0], point[1]));
    chart.draw_series(LineSeries::new(line, pen(1)))?;
    draw_pieces(&mut chart, curve, &y)?;
    draw_certified(&mut chart, curve, &x, &y)
}

/// The torque of each tick, with one dot per pixel.
fn draw_dots(chart: &Plane<'_, '_>, turn: &FeltTurn) -> Drawn<()> {
    let (plane, area) = (chart.plotting_area(), chart.plotting_area().strip_coord_spec());
    let (base, shown) = (plane.get_base_pixel(), plane.get_x_range());
    let ticks = turn.angle.iter().zip(&turn.torque).filter(|(angle, _)| shown.contains(*angle));
    let mut drawn = HashSet::new();
    for (angle, torque) in ticks {
        let (x, y) = plane.map_coordinate(&(*angle, *torque));
        if drawn.insert((x / units(1), y / units(1))) {
            area.draw(&dot_at((x - base.0, y - base.1)))?;
        }
    }
    Ok(())
}

/// A quantity over time, with the hand's set-point.
fn over_time(
    area: &Area<'_>,
    turn: &FeltTurn,
    values: &[f64],
    wanted: Option<&[f64]>,
    (below, name): (Option<&str>, &str),
) -> Drawn<()> {
    let end = turn.time.last().copied().unwrap_or(1.0);
    let all = values.iter().chain(wanted.unwrap_or_default()).copied();
    let y = padded(span(all), 0.12);
    let room = if below.is_some() { X_LABELS } else { units(24) };
    let mut chart = axes::chart(area)
        .margin_top(units(4))
        .margin_bottom(units(2))
        .margin_right(MARGIN_RIGHT)
        .x_label_area_size(room)
        .build_cartesian_2d(0.0..end, y)?;
    Axes { most: (11, 6), ..Axes::named(below, name) }.draw(&mut chart)?;
    for (values, dash, width) in [(wanted.unwrap_or_default(), HAND, 1), (values, SOLID, 2)] {
        let (plane, area) = (chart.plotting_area(), chart.plotting_area().strip_coord_spec());
        let base = plane.get_base_pixel();
        let place = |(time, value): (&f64, &f64)| {
            let (x, y) = plane.map_coordinate(&(*time, *value));
            (x - base.0, y - base.1)
        };
        let line: Vec<_> = turn.time.iter().zip(values).map(place).collect();
        dash.draw(&area, &line, width)?;
    }
    Ok(())
}
