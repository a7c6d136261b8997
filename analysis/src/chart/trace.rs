//! Position and torque over time.

use std::path::Path;

use firmware::torque::LimitReason;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::*;

/// A run to draw.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// What it is called.
    pub title: String,
    /// Seconds between two samples.
    pub period: f64,
    /// Angle of the device in rad, a sample each.
    pub position: Vec<f64>,
    /// Where the hand wanted to be in rad, as long as it held the device.
    pub hand: Vec<f64>,
    /// Coupling torque in N m.
    pub torque: Vec<f64>,
    /// Why the torque is less than the scene asked for.
    pub limit: Vec<LimitReason>,
    /// When the hand lets go, in s.
    pub release: Option<f64>,
    /// Angle in rad beyond which a one-sided wall is felt.
    pub face: Option<f64>,
}

/// Draws position above torque, over one time axis. Where the torque is limited the ground is
/// grey.
///
/// # Errors
/// Where there are fewer than two samples, or the file cannot be written.
pub fn trace(path: &Path, trace: &Trace) -> Result<(), ChartError> {
    if trace.position.len() < 2 || trace.torque.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    draw(path, |area| {
        let area = area.margin(units(10), 0, 0, 0).titled(&trace.title, text(TITLE))?;
        let area = area.titled(legend(trace), text(LABEL))?;
        let (upper, lower) = area.split_vertically(units(SIZE.1 as i32) * 48 / 100);
        position(&upper, trace)?;
        torque(&lower, trace)
    })
}

fn position(area: &Area<'_>, trace: &Trace) -> Drawn<()> {
    let range = span(trace.position.iter().chain(&trace.hand).copied());
    let y = padded(range, 0.16);
    let time = 0.0..trace.period * trace.position.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(MARGIN)
        .margin_right(MARGIN_RIGHT)
        .x_label_area_size(units(24))
        .y_label_area_size(Y_LABELS)
        .build_cartesian_2d(time.clone(), y.clone())?;
    mesh(&mut chart, "angle (rad)", None)?;
    if let Some(face) = trace.face {
        let line = [(time.start, face), (time.end, face)];
        chart.draw_series(broken(line, 2, 4, 1))?;
        let place = (time.end, face - 0.02 * (y.end - y.start));
        let style = anchored(HPos::Right, VPos::Top);
        chart.draw_series([Text::new("face of the wall", place, style)])?;
    }
    chart.draw_series(broken(sampled(&trace.hand, trace.period), 6, 4, 1))?;
    chart.draw_series(LineSeries::new(sampled(&trace.position, trace.period), pen(2)))?;
    release(&mut chart, trace, &y, true)
}

/// What the lines are, above the picture, where no curve can come in the way.
fn legend(trace: &Trace) -> &'static str {
    if trace.hand.is_empty() {
        "solid: device"
    } else {
        "solid: device; broken: where the hand wants to be"
    }
}

fn torque(area: &Area<'_>, trace: &Trace) -> Drawn<()> {
    let y = padded(span(trace.torque.iter().copied()), 0.12);
    let time = 0.0..trace.period * trace.torque.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(MARGIN)
        .margin_right(MARGIN_RIGHT)
        .x_label_area_size(X_LABELS)
        .y_label_area_size(Y_LABELS)
        .build_cartesian_2d(time, y.clone())?;
    let limited = limited(&trace.limit).into_iter().map(|range| {
        let [from, to] = [range.start, range.end].map(|sample| sample as f64 * trace.period);
        Rectangle::new([(from, y.start), (to, y.end)], FORBIDDEN.filled())
    });
    chart.draw_series(limited)?;
    mesh(&mut chart, "coupling torque (N m)", Some("time (s)"))?;
    chart.draw_series(LineSeries::new(sampled(&trace.torque, trace.period), pen(1)))?;
    release(&mut chart, trace, &y, false)
}

type Plane<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn mesh(chart: &mut Plane<'_, '_>, y: &str, x: Option<&str>) -> Drawn<()> {
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(UNITS))
        .axis_style(pen(1))
        .set_all_tick_mark_size(units(5))
        .y_desc(y)
        .y_labels(6)
        .x_label_formatter(&axis_number)
        .y_label_formatter(&axis_number)
        .label_style(text(LABEL));
    if let Some(x) = x {
        mesh.x_desc(x);
    }
    mesh.draw()
}

fn release(chart: &mut Plane<'_, '_>, trace: &Trace, y: &Range<f64>, named: bool) -> Drawn<()> {
    let Some(time) = trace.release else { return Ok(()) };
    let line = [(time, y.start), (time, y.end)];
    chart.draw_series(broken(line, 8, 5, 1))?;
    if named {
        let place = (time + 0.01 * trace.period * trace.position.len() as f64, y.end);
        chart.draw_series([Text::new("lets go", place, anchored(HPos::Left, VPos::Top))])?;
    }
    Ok(())
}

fn sampled(values: &[f64], period: f64) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(sample, &value)| (sample as f64 * period, value)).collect()
}

/// Runs of samples that were limited.
fn limited(reasons: &[LimitReason]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (sample, _) in
        reasons.iter().enumerate().filter(|(_, reason)| **reason != LimitReason::None)
    {
        match runs.last_mut() {
            Some(run) if run.end == sample => run.end = sample + 1,
            _ => runs.push(sample..sample + 1),
        }
    }
    runs
}
