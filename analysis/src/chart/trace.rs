//! Position and torque over time.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::hatch::Ground;
use super::*;
use crate::file::SceneFile;
use crate::quantity::{shortened, significant};
use crate::simulation::served::Served;
use crate::simulation::{Experiment, SimulationError, Stride, simulate, wall};

/// What the samples are counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// Seconds.
    #[default]
    Seconds,
    /// Ticks, of a period that is not known.
    Ticks,
}

/// A run to draw.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// What it is called.
    pub title: String,
    /// What the times are in.
    pub clock: Clock,
    /// When the samples were taken, each later than the one before.
    pub time: Vec<f64>,
    /// Angle of the device in rad, a sample each.
    pub position: Vec<f64>,
    /// Where the hand wanted to be in rad, as long as it held the device.
    pub hand: Vec<f64>,
    /// Coupling torque in N m.
    pub torque: Vec<f64>,
    /// Why the torque is not what the scene asked for.
    pub limit: Vec<Served>,
    /// When the hand lets go, on the same clock.
    pub release: Option<f64>,
    /// Angle in rad beyond which a one-sided wall is felt.
    pub face: Option<f64>,
    /// When the run went beyond what a picture can show, if it did; there are no samples from
    /// there on.
    pub lost: Option<f64>,
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
        let period = file.scene.timing.period;
        let trace = Self {
            title: file.name.clone(),
            clock: Clock::Seconds,
            time: (0..experiment.samples).map(|sample| sample as f64 * period).collect(),
            position: motion.position,
            torque: motion.torque,
            limit: motion.limit,
            face: wall(&file.scene).filter(|wall| wall.one_sided).map(|wall| wall.face),
            ..Self::default()
        };
        Ok(trace.as_far_as_drawable())
    }

    /// Ends the run where a picture cannot show it any more, or where there is no more of it.
    pub fn as_far_as_drawable(mut self) -> Self {
        let both = self.position.iter().zip(&self.torque);
        let kept = both.take_while(|(x, f)| is_drawable(**x) && is_drawable(**f)).count();
        self.lost = self.time.get(kept).copied();
        self.time.truncate(kept);
        for column in [&mut self.position, &mut self.torque, &mut self.hand] {
            column.truncate(kept);
        }
        self.limit.truncate(kept);
        self
    }

    /// When a sample begins, and when the last one ends.
    fn begin(&self, sample: usize) -> f64 {
        match (self.time.get(sample), &self.time[..]) {
            (Some(&time), _) => time,
            (None, [.., before, last]) => 2.0 * last - before,
            (None, _) => 0.0,
        }
    }

    /// From the first sample to the end of the last.
    fn times(&self) -> Range<f64> {
        self.begin(0)..self.begin(self.time.len())
    }

    /// What limited the torque, each once.
    fn reasons(&self) -> Vec<(Served, Ground)> {
        let occurs = |served: &Served| self.limit.contains(served);
        let grounded = |served| Some((served, Ground::of(served)?));
        Served::all().filter(occurs).filter_map(grounded).collect()
    }
}

/// Height of the line of the key that names the grounds, in pixels.
const ROW: i32 = 24;

/// Draws position above torque, over one time axis. Where the torque was limited or a tick was
/// missed, the ground says why.
///
/// # Errors
/// Where there are fewer than two samples.
pub fn trace(trace: &Trace) -> Result<Picture, ChartError> {
    let samples = trace.time.len();
    if samples < 2 || trace.position.len() != samples || trace.torque.len() != samples {
        return Err(ChartError::TooFewPoints);
    }
    let reasons = trace.reasons();
    let key = if reasons.is_empty() { 0 } else { ROW };
    draw_sized((SIZE.0, SIZE.1 + key as u32), |area| {
        let area =
            area.margin(units(10), 0, 0, 0).titled(&shortened(&trace.title, 72), text(TITLE))?;
        let area = area.titled(&legend(trace), text(LABEL))?;
        let (grounds, area) = area.split_vertically(units(key));
        write_grounds(&grounds, &reasons)?;
        let (upper, lower) = area.split_vertically(units(SIZE.1 as i32) * 48 / 100);
        position(&upper, trace)?;
        torque(&lower, trace, &reasons)
    })
}

fn position(area: &Area<'_>, trace: &Trace) -> Drawn<()> {
    let range = span(trace.position.iter().chain(&trace.hand).copied());
    let y = padded(range, 0.16);
    let time = trace.times();
    let mut chart = axes::chart(area)
        .margin_right(MARGIN_RIGHT)
        .x_label_area_size(units(24))
        .build_cartesian_2d(time.clone(), y.clone())?;
    Axes::named(None, "angle (rad)").draw(&mut chart)?;
    if let Some(face) = trace.face.filter(|face| y.contains(face)) {
        let line = [(time.start, face), (time.end, face)];
        chart.draw_series(broken(line, 2, 4, 1))?;
    }
    chart.draw_series(broken(sampled(&trace.hand, trace), 6, 4, 1))?;
    chart.draw_series(LineSeries::new(sampled(&trace.position, trace), pen(2)))?;
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
    if let Some(lost) = trace.lost {
        let unit = match trace.clock {
            Clock::Seconds => "s",
            Clock::Ticks => "ticks",
        };
        let when = significant(lost, 6);
        words.push(format!("not drawn from {when} {unit} on: too large for a picture"));
    }
    words.join("; ")
}

/// What the grounds of the torque mean, side by side.
fn write_grounds(area: &Area<'_>, reasons: &[(Served, Ground)]) -> Drawn<()> {
    const SWATCH: i32 = 30;
    const GAP: i32 = 8;
    // About as wide as letters are.
    let width = |name: &str| SWATCH + 3 * GAP + 7 * name.len() as i32;
    let all: i32 = reasons.iter().map(|(served, _)| width(name(*served))).sum();
    let mut x = (SIZE.0 as i32 - all) / 2;
    for &(served, ground) in reasons {
        ground.swatch(area, &(units(x)..units(x + SWATCH)), &(units(4)..units(ROW - 4)))?;
        let place = (units(x + SWATCH + GAP), units(ROW / 2));
        let style = anchored(HPos::Left, VPos::Center);
        area.draw(&Text::new(name(served), place, style))?;
        x += width(name(served));
    }
    Ok(())
}

/// What a ground means.
fn name(served: Served) -> &'static str {
    use firmware::torque::LimitReason::{Angle, Converter, None, NotANumber, Ramp, Torque};
    match served {
        Served::Ran(None) => "not limited",
        Served::Ran(Torque) => "torque limit",
        Served::Ran(Converter) => "converter limit",
        Served::Ran(Angle) => "angle out of range",
        Served::Ran(NotANumber) => "not a number",
        Served::Ran(Ramp) => "fading in or out",
        Served::Missed => "tick missed",
    }
}

fn torque(area: &Area<'_>, trace: &Trace, reasons: &[(Served, Ground)]) -> Drawn<()> {
    let y = padded(span(trace.torque.iter().copied()), 0.12);
    let mut chart = axes::chart(area)
        .margin_right(MARGIN_RIGHT)
        .build_cartesian_2d(trace.times(), y.clone())?;
    for &(served, ground) in reasons {
        shade(&chart, trace, served, ground)?;
    }
    let axis = match trace.clock {
        Clock::Seconds => "time (s)",
        Clock::Ticks => "time (ticks)",
    };
    Axes::named(axis, "coupling torque (N m)").draw(&mut chart)?;
    chart.draw_series(LineSeries::new(sampled(&trace.torque, trace), pen(1)))?;
    release(&mut chart, trace, &y, false)
}

/// Covers the ground of the samples that were served so.
fn shade(chart: &Plane<'_, '_>, trace: &Trace, served: Served, ground: Ground) -> Drawn<()> {
    let plot = chart.plotting_area();
    let area = plot.strip_coord_spec();
    let (width, height) = area.dim_in_pixel();
    let (left, bottom) = (plot.get_base_pixel().0, plot.get_y_range().start);
    let place = |sample| plot.map_coordinate(&(trace.begin(sample), bottom)).0 - left;
    for run in runs(&trace.limit, served, place) {
        ground.fill(&area, &(run.start..run.end.min(width as i32)), &(0..height as i32))?;
    }
    Ok(())
}

/// Where samples that were served so are, in units of the drawing: at least a pixel each, and one
/// where they are less than a pixel apart.
fn runs(limit: &[Served], served: Served, place: impl Fn(usize) -> i32) -> Vec<Range<i32>> {
    let mut runs: Vec<Range<i32>> = Vec::new();
    for (sample, _) in limit.iter().enumerate().filter(|(_, is)| **is == served) {
        let from = place(sample);
        let to = place(sample + 1).max(from + units(1));
        match runs.last_mut() {
            Some(run) if from < run.end + units(1) => run.end = to,
            _ => runs.push(from..to),
        }
    }
    runs
}

fn release(chart: &mut Plane<'_, '_>, trace: &Trace, y: &Range<f64>, named: bool) -> Drawn<()> {
    let Some(time) = trace.release else { return Ok(()) };
    let line = [(time, y.start), (time, y.end)];
    chart.draw_series(broken(line, 8, 5, 1))?;
    if named {
        let times = trace.times();
        let place = (time + 0.01 * (times.end - times.start), y.end);
        chart.draw_series([Text::new("lets go", place, anchored(HPos::Left, VPos::Top))])?;
    }
    Ok(())
}

/// Most parts of a curve that a picture can show.
const PARTS: usize = 2000;

/// The samples as points. Of more than a picture can show, each part's ends, least and largest.
fn sampled(values: &[f64], trace: &Trace) -> Vec<(f64, f64)> {
    let points: Vec<_> = trace.time.iter().copied().zip(values.iter().copied()).collect();
    if points.len() <= 4 * PARTS {
        return points.into_iter().filter(|point| is_drawable(point.1)).collect();
    }
    let part = |points: &[(f64, f64)]| {
        let order = |a: &usize, b: &usize| points[*a].1.total_cmp(&points[*b].1);
        let finite = || (0..points.len()).filter(|&i| is_drawable(points[i].1));
        let ends = [finite().next(), finite().next_back()];
        let extremes = [finite().min_by(order), finite().max_by(order)];
        let mut kept: Vec<usize> = ends.into_iter().chain(extremes).flatten().collect();
        kept.sort_unstable();
        kept.dedup();
        kept.into_iter().map(|i| points[i]).collect::<Vec<_>>()
    };
    points.chunks(points.len().div_ceil(PARTS)).flat_map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_one_reason_are_one_ground_and_none_is_lost() {
        let [ran, missed] = [Served::IN_FULL, Served::Missed];
        let limit = [ran, missed, missed, ran, missed, ran, ran, ran, missed];
        let wide = runs(&limit, missed, |sample| units(10 * sample as i32));
        assert_eq!(wide, [units(10)..units(30), units(40)..units(50), units(80)..units(90)]);
        // Four samples a pixel.
        let narrow = runs(&limit, missed, |sample| units(1) * sample as i32 / 4);
        assert_eq!((narrow.len(), &narrow[0]), (1, &(units(1) / 4..units(3))));
    }

    #[test]
    fn a_long_curve_keeps_its_ends_and_its_spikes() {
        let mut values = vec![0.0; 100_000];
        (values[0], values[41_234], values[41_235], values[99_999]) = (1.0, 9.0, -9.0, 2.0);
        let time = (0..values.len()).map(|i| i as f64).collect();
        let points = sampled(&values, &Trace { time, ..Trace::default() });
        assert!(points.len() <= 4 * PARTS);
        for kept in [(0.0, 1.0), (41_234.0, 9.0), (41_235.0, -9.0), (99_999.0, 2.0)] {
            assert!(points.contains(&kept), "{kept:?}");
        }
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
    }
}
