//! A torque profile: torque and potential over angle, the steepest pieces, and the steepest slope that
//! certifies.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::Dash;
use super::*;
use crate::profile_curve::{Piece, ProfileCurve};
use crate::quantity::significant;
use crate::snap_branches::Branch;

/// Heights of the two panels in pixels.
const PANELS: [i32; 2] = [330, 220];
/// Height of a line of the legend in pixels.
const ROW: i32 = 22;
/// Largest extent of the line of the certified slope, relative to the chart's width and height.
const REACH: f64 = 0.2;

/// Draws a profile. `limit`: the torque limit in N m.
///
/// # Errors
/// If the drawing fails.
pub fn profile(
    title: &str,
    curve: &ProfileCurve,
    limit: Option<f64>,
) -> Result<Picture, ChartError> {
    let rows = legend(curve, limit);
    let height = TITLE_ROOM + PANELS[0] + PANELS[1] + ROW * rows.len() as i32 + 16;
    draw_sized((SIZE.0, height as u32), |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(title, text(TITLE))?;
        let (above, area) = area.split_vertically(units(PANELS[0]));
        let (below, words) = area.split_vertically(units(PANELS[1]));
        torque(&above, curve, limit)?;
        potential(&below, curve)?;
        write_legend(&words, &rows)
    })
}

fn angles(curve: &ProfileCurve) -> Range<f64> {
    padded(span(curve.points.iter().map(|point| point[0])), 0.02)
}

fn torque(area: &Area<'_>, curve: &ProfileCurve, limit: Option<f64>) -> Drawn<()> {
    let x = angles(curve);
    let of_branches = curve.branches.iter().flat_map(|branch| &branch.points);
    let own = span(curve.points.iter().map(|p| p[1]).chain(of_branches.map(|p| p[1])));
    let y = padded(own.clone(), 0.12);
    let mut chart =
        axes::chart(area).margin_right(MARGIN_RIGHT).build_cartesian_2d(x.clone(), y.clone())?;
    let names = Axes::named(None, "torque (N m)");
    Axes { most: (11, 8), ..names }.draw(&mut chart)?;
    chart.draw_series([PathElement::new([(x.start, 0.0), (x.end, 0.0)], pen(1))])?;
    if let Some(limit) = limit {
        for level in [-limit, limit].into_iter().filter(|level| y.contains(level)) {
            chart.draw_series(broken([(x.start, level), (x.end, level)], 2, 4, 1))?;
        }
    }
    let line = curve.points.iter().map(|point| (point[0], point[1]));
    if curve.branches.is_empty() {
        chart.draw_series(LineSeries::new(line, pen(1)))?;
    }
    for Branch { points, snaps } in &curve.branches {
        let shown = points.iter().filter(|point| x.contains(&point[0]));
        chart.draw_series(LineSeries::new(shown.map(|point| (point[0], point[1])), pen(1)))?;
        for &[angle, before, after] in snaps.iter().filter(|snap| x.contains(&snap[0])) {
            chart.draw_series(broken([(angle, before), (angle, after)], 2, 4, 1))?;
            chart.draw_series([Circle::new((angle, before), units(3), BLACK.filled())])?;
        }
    }
    draw_pieces(&mut chart, curve, &y)?;
    draw_certified(&mut chart, curve, &x, &y)
}

/// The steepest pieces.
pub(super) fn draw_pieces(
    chart: &mut Plane<'_, '_>,
    curve: &ProfileCurve,
    y: &Range<f64>,
) -> Drawn<()> {
    for piece in [curve.rise, curve.fall] {
        let half = 0.5 * piece.width;
        let ends = [-half, half].map(|by| (piece.angle + by, piece.torque + by * piece.slope));
        let ends = ends.map(|(x, f)| (x, f.clamp(y.start, y.end)));
        chart.draw_series([PathElement::new(ends, pen(4))])?;
    }
    Ok(())
}

/// The steepest rise that certifies.
pub(super) fn draw_certified(
    chart: &mut Plane<'_, '_>,
    curve: &ProfileCurve,
    x: &Range<f64>,
    y: &Range<f64>,
) -> Drawn<()> {
    if let Some(slope) = curve.certified {
        let ends = certified(&curve.rise, slope, x, y);
        chart.draw_series(broken(ends, 9, 5, 2))?;
    }
    Ok(())
}

/// A line of the certified slope through the middle of the steepest rise, inside the chart.
fn certified(rise: &Piece, slope: f64, x: &Range<f64>, y: &Range<f64>) -> [(f64, f64); 2] {
    let room = (y.end - rise.torque).min(rise.torque - y.start).max(0.0);
    let wide = (REACH * (x.end - x.start)).min(x.end - rise.angle).min(rise.angle - x.start);
    let half = wide.min(room / slope);
    [-half, half].map(|by| (rise.angle + by, rise.torque + by * slope))
}

fn potential(area: &Area<'_>, curve: &ProfileCurve) -> Drawn<()> {
    let millijoules = |point: &[f64; 3]| (point[0], 1e3 * point[2]);
    let y = padded(span(curve.points.iter().map(|point| 1e3 * point[2])), 0.08);
    let mut chart =
        axes::chart(area).margin_right(MARGIN_RIGHT).build_cartesian_2d(angles(curve), y)?;
    let names = Axes::named("angle (rad)", "potential (mJ)");
    Axes { most: (11, 6), ..names }.draw(&mut chart)?;
    chart.draw_series(LineSeries::new(curve.points.iter().map(millijoules), pen(1)))?;
    Ok(())
}

/// A line of the legend: its pattern, its width in pixels, its words.
pub(super) type Row = (Dash, u32, String);

/// The legend of the slopes and of the limit.
pub(super) fn legend(curve: &ProfileCurve, limit: Option<f64>) -> Vec<Row> {
    let slope = |value: f64| significant(value, 4);
    let mut rows = vec![(
        Dash::of(0),
        4,
        format!(
            "steepest rise, {} N m/rad, and steepest fall, {} N m/rad",
            slope(curve.rise.slope),
            slope(curve.fall.slope)
        ),
    )];
    let bound = curve.certified.map_or_else(
        || "no rise certifies".to_owned(),
        |bound| format!("steepest rise that certifies, {} N m/rad", slope(bound)),
    );
    rows.push((Dash::new(&[9, 5]), 2, bound));
    if !curve.branches.is_empty() {
        let words = "a detent snaps to the next one, from the dot on".to_owned();
        rows.push((Dash::of(2), 1, words));
    }
    rows.extend(
        limit.map(|limit| (Dash::of(2), 1, format!("torque limit, {} N m", significant(limit, 4)))),
    );
    rows
}

fn write_legend(area: &Area<'_>, rows: &[Row]) -> Drawn<()> {
    for (row, (dash, width, words)) in rows.iter().enumerate() {
        let y = units(ROW * row as i32 + ROW / 2);
        dash.draw(area, &[(units(30), y), (units(90), y)], *width)?;
        let style = anchored(HPos::Left, VPos::Center);
        area.draw(&Text::new(words.clone(), (units(102), y), style))?;
    }
    Ok(())
}
