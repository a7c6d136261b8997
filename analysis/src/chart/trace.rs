//! Position and torque over time.

use std::path::Path;

use firmware::torque::LimitReason;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::*;
use crate::file::SceneFile;
use crate::quantity::shortened;
use crate::simulation::{Experiment, SimulationError, Stride, simulate, wall};

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

impl Trace {
    /// What a scene file's simulation does, taken exactly through each tick; `folder` is where its
    /// torque file is looked for.
    ///
    /// # Errors
    /// Where the file has no `[simulation]`, or its scene cannot run.
    pub fn simulated(file: &SceneFile, folder: &Path) -> Result<Self, SimulationError> {
        let experiment = Experiment::of(file, folder)?;
        let motion = simulate(&experiment, Stride::default())?;
        let reason = |torque: &f64| match file.scene.torque_limit {
            // The limit itself is only met where it acts.
            Some(limit) if torque.abs() >= limit * (1.0 - NEAR) => LimitReason::Torque,
            _ => LimitReason::None,
        };
        Ok(Self {
            title: file.name.clone(),
            period: file.scene.timing.period,
            limit: motion.torque.iter().map(reason).collect(),
            position: motion.position,
            torque: motion.torque,
            hand: Vec::new(),
            release: None,
            face: wall(&file.scene).filter(|wall| wall.one_sided).map(|wall| wall.face),
        })
    }
}

/// Part of the torque limit by which rounding may miss it.
const NEAR: f64 = 1e-9;

/// Draws position above torque, over one time axis. Where the torque is limited the ground is
/// grey.
///
/// # Errors
/// Where there are fewer than two samples.
pub fn trace(trace: &Trace) -> Result<Picture, ChartError> {
    if trace.position.len() < 2 || trace.torque.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    draw(|area| {
        let area =
            area.margin(units(10), 0, 0, 0).titled(&shortened(&trace.title, 72), text(TITLE))?;
        let area = area.titled(&legend(trace), text(LABEL))?;
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
    mesh(&mut chart, None, "angle (rad)")?;
    if let Some(face) = trace.face {
        let line = [(time.start, face), (time.end, face)];
        chart.draw_series(broken(line, 2, 4, 1))?;
    }
    chart.draw_series(broken(sampled(&trace.hand, trace.period), 6, 4, 1))?;
    chart.draw_series(LineSeries::new(sampled(&trace.position, trace.period), pen(2)))?;
    release(&mut chart, trace, &y, true)
}

/// What the lines are, above the picture, where no curve can come in the way.
fn legend(trace: &Trace) -> String {
    let mut words = vec!["solid: device".to_owned()];
    if trace.face.is_some() {
        words.push("dotted: face of the wall".to_owned());
    }
    if !trace.hand.is_empty() {
        words.push("broken: where the hand wants to be".to_owned());
    }
    let mut reasons: Vec<_> =
        trace.limit.iter().filter(|reason| **reason != LimitReason::None).collect();
    reasons.sort_by_key(|reason| **reason as u8);
    reasons.dedup();
    if !reasons.is_empty() {
        let names: Vec<_> = reasons.iter().map(|reason| reason.as_str()).collect();
        words.push(format!("grey: limited ({})", names.join(", ")));
    }
    words.join("; ")
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
    mesh(&mut chart, Some("time (s)"), "coupling torque (N m)")?;
    chart.draw_series(LineSeries::new(sampled(&trace.torque, trace.period), pen(1)))?;
    release(&mut chart, trace, &y, false)
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
