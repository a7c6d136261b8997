//! The stiffest certified spring over the servo's rate, one panel for each current loop, compared with the
//! common assumptions.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::Dash;
use super::*;
use crate::latency_limits::{LatencyLimits, LatencyPoint};
use crate::quantity::significant;

/// Height of a row of panels, and of a line of the legend, in pixels.
const PANEL: i32 = 330;
const ROW: i32 = 20;
/// Panels beside each other.
const COLUMNS: usize = 2;

/// A curve: its name, and its stiffness in N m/rad at a rate.
type Curve = (&'static str, fn(&LatencyPoint) -> Option<f64>);

/// From the highest limit to the limit without a proof.
const CURVES: [Curve; 4] = [
    ("torque at a fixed phase: certified", |point| point.at_phase),
    ("torque latched by the next count: certified", |point| Some(point.latched)),
    ("latched, lag rounded up to whole samples: certified", |point| point.whole_samples),
    ("b/(T/2 + tau), which leaves the latch out", |point| Some(point.folklore)),
];

/// Draws a panel for each current loop. A cross marks a rate at which a hand is known in which the last
/// curve's spring oscillates on a board with latched torques.
///
/// # Errors
/// If there are fewer than two points.
pub fn latency(title: &str, loops: &[LatencyLimits]) -> Result<Picture, ChartError> {
    let points = || loops.iter().flat_map(|limits| &limits.points);
    let rates = span(points().map(|point| point.rate));
    let values = || points().flat_map(|point| CURVES.iter().filter_map(|curve| curve.1(point)));
    let stiffness = span(values().filter(|&value| value > 0.0));
    if rates.start >= rates.end || stiffness.start >= stiffness.end {
        return Err(ChartError::TooFewPoints);
    }
    let stiffness = stiffness.start / 1.2..stiffness.end * 1.2;
    let rows = loops.len().div_ceil(COLUMNS);
    let legend = ROW * (CURVES.len() as i32 + 1) + 16;
    let size = (SIZE.0, (TITLE_ROOM + PANEL * rows as i32 + legend) as u32);
    draw_sized(size, |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(title, text(TITLE))?;
        let (panels, below) = area.split_vertically(units(PANEL * rows as i32));
        for (limits, panel) in loops.iter().zip(panels.split_evenly((rows, COLUMNS))) {
            paint(&panel, limits, rates.clone(), stiffness.clone())?;
        }
        write_legend(&below)
    })
}

fn paint(
    area: &Area<'_>,
    limits: &LatencyLimits,
    rates: Range<f64>,
    stiffness: Range<f64>,
) -> Drawn<()> {
    let mut chart =
        axes::chart(area).build_cartesian_2d(rates.clone().log_scale(), stiffness.log_scale())?;
    let names = Axes::named("servo rate (Hz)", "stiffness (N m/rad)");
    Axes { most: (8, 8), ..names }.draw(&mut chart)?;
    let (plane, area) = (chart.plotting_area(), chart.plotting_area().strip_coord_spec());
    let (x, y) = plane.get_base_pixel();
    let place = |rate: f64, stiffness: f64| {
        let (px, py) = plane.map_coordinate(&(rate, stiffness));
        (px - x, py - y)
    };
    for (index, (_, value)) in CURVES.iter().enumerate() {
        let line = limits.points.iter().filter_map(|p| Some(place(p.rate, value(p)?)));
        Dash::of(index).draw(&area, &line.collect::<Vec<_>>(), if index < 2 { 2 } else { 1 })?;
    }
    for point in limits.points.iter().step_by(4).filter(|point| point.folklore_is_unsafe()) {
        let at = place(point.rate, point.folklore);
        area.draw(&Cross::new(at, units(4), pen(1)))?;
    }
    let name = format!("current loop of {} Hz", significant(limits.bandwidth, 3));
    area.draw(&Text::new(name, (units(10), units(14)), anchored(HPos::Left, VPos::Center)))
}

fn write_legend(area: &Area<'_>) -> Drawn<()> {
    let style = || anchored(HPos::Left, VPos::Center);
    let middle = |row: usize| units(ROW * row as i32 + ROW / 2);
    for (row, (name, _)) in CURVES.iter().enumerate() {
        let y = middle(row);
        Dash::of(row).draw(area, &[(units(20), y), (units(90), y)], 2)?;
        area.draw(&Text::new(*name, (units(102), y), style()))?;
    }
    let y = middle(CURVES.len());
    area.draw(&Cross::new((units(55), y), units(4), pen(1)))?;
    let words = "it oscillates in some passive hand, with torques latched";
    area.draw(&Text::new(words, (units(102), y), style()))
}
