//! The stiffest certified spring over the servo's rate, one panel for each current loop, compared with the
//! common assumptions.

use super::*;
use crate::latency_limits::{LatencyLimits, LatencyPoint};
use crate::quantity::significant;

/// Height of a row of panels in pixels.
const PANEL: i32 = 330;
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
pub fn latency(title: &str, loops: &[LatencyLimits]) -> Result<Picture, ChartError> {
    let points = || loops.iter().flat_map(|limits| &limits.points);
    let rates = span(points().map(|point| point.rate));
    let values = || points().flat_map(|point| CURVES.iter().filter_map(|curve| curve.1(point)));
    let stiffness = span(values().filter(|&value| value > 0.0));
    if rates.start >= rates.end || stiffness.start >= stiffness.end {
        return Err(ChartError::TooFewPoints);
    }
    let stiffness = stiffness.start / 1.2..stiffness.end * 1.2;
    let axes = [
        Axis::logarithmic(rates, "servo rate (Hz)"),
        Axis::logarithmic(stiffness, "stiffness (N m/rad)"),
    ];
    let unsafe_point = "it oscillates in some passive hand, with torques latched";
    let curves = CURVES.iter().enumerate();
    let curves = curves.map(|(index, curve)| (Sample::Line(stroke(index)), curve.0));
    let entries = curves.chain([(Sample::Point(Mark::CROSS), unsafe_point)]);
    let rows = loops.len().div_ceil(COLUMNS);
    Page::new(title, &[PANEL * rows as i32]).legend(1, entries).draw(|areas| {
        let areas = areas[0].split_evenly((rows, COLUMNS));
        loops.iter().zip(&areas).try_for_each(|(limits, area)| paint(area, limits, &axes))
    })
}

/// The line of the curve with this number.
fn stroke(index: usize) -> Stroke {
    Stroke::of(index, if index < 2 { 2 } else { 1 })
}

fn paint(area: &Area<'_>, limits: &LatencyLimits, axes: &[Axis; 2]) -> Drawn<()> {
    let heading = format!("current loop of {} Hz", significant(limits.bandwidth, 3));
    let [x, y] = axes.clone();
    let panel = Panel::headed(area, &heading, x, y)?;
    for (index, (_, value)) in CURVES.iter().enumerate() {
        let line = limits.points.iter().filter_map(|point| Some((point.rate, value(point)?)));
        panel.curve(stroke(index), line)?;
    }
    let marked = limits.points.iter().step_by(4).filter(|point| point.folklore_is_unsafe());
    marked.into_iter().try_for_each(|point| panel.mark(Mark::CROSS, (point.rate, point.folklore)))
}
