//! Position, velocity and torque over time.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::{Dash, SOLID};
use super::hatch::Ground;
use super::sheet::{Frame, whole};
use super::*;
use crate::file::SceneFile;
use crate::quantity::{shortened, significant};
use crate::simulation::drive::Drive;
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
    /// Velocity in rad/s, a sample each; empty where it was not recorded, to be taken from the angle.
    pub velocity: Vec<f64>,
    /// Coupling torque in N m; the motor applies the opposite.
    pub torque: Vec<f64>,
    /// Torque in N m with which the hand drives the device, in the direction of the angle; empty where
    /// it is not known or there is none.
    pub hand_torque: Vec<f64>,
    /// What the torque is limited to, in N m.
    pub torque_limit: Option<f64>,
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
        let drive = |k: usize| experiment.drive.held(k) + experiment.drive.sine(k, period)[0];
        let is_driven = experiment.drive != Drive::Free;
        let driven = is_driven.then(|| (0..experiment.samples).map(drive).collect());
        let trace = Self {
            title: file.name.clone(),
            clock: Clock::Seconds,
            time: (0..experiment.samples).map(|sample| sample as f64 * period).collect(),
            position: motion.position,
            velocity: motion.velocity,
            torque: motion.torque,
            hand_torque: driven.unwrap_or_default(),
            torque_limit: file.scene.torque_limit,
            limit: motion.limit,
            face: wall(&file.scene).filter(|wall| wall.one_sided).map(|wall| wall.face),
            ..Self::default()
        };
        Ok(trace.as_far_as_drawable())
    }

    /// Ends the run where a picture cannot show it any more, or where there is no more of it.
    pub fn as_far_as_drawable(mut self) -> Self {
        let fine = |column: &[f64], i: usize| column.get(i).is_none_or(|value| is_drawable(*value));
        let all = |&i: &usize| {
            [&self.position, &self.velocity, &self.torque].iter().all(|column| fine(column, i))
        };
        let recorded = self.position.len().min(self.torque.len());
        let kept = (0..recorded).take_while(all).count();
        self.lost = self.time.get(kept).copied();
        self.time.truncate(kept);
        for column in [
            &mut self.position,
            &mut self.velocity,
            &mut self.torque,
            &mut self.hand,
            &mut self.hand_torque,
        ] {
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

    /// Samples over which a velocity is taken that was not recorded: as many as a picture does not
    /// show apart, and as many more, up to a [`SMEARED`] part of the run, as make a step of the
    /// encoder a small part of the velocities.
    fn window(&self) -> usize {
        let last = self.time.len().saturating_sub(1).max(1);
        let (least, most) = ((self.time.len() / 400).clamp(1, last), (last / SMEARED).max(1));
        let Some(step) = self.step() else { return least };
        let sample = (self.time[last] - self.time[0]) / last as f64;
        let is_fine = |window: &usize| {
            let fastest = self.means(*window).fold(0.0, |fastest: f64, v| fastest.max(v.abs()));
            STEPS * step <= fastest * sample * *window as f64
        };
        let wider = std::iter::successors(Some(least), |window| Some(window + window.div_ceil(4)));
        wider.take_while(|window| *window < most).find(is_fine).unwrap_or(most.max(least))
    }

    /// The encoder's step: the least by which changes of the angle from a sample to the next differ,
    /// of some size beside the largest; `None` if it never changes.
    fn step(&self) -> Option<f64> {
        /// What is smaller, as a part of the largest change, has come of rounded numbers.
        const ROUNDED: f64 = 1e-6;
        let changes = self.position.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let mut changes: Vec<_> = changes.chain([0.0]).collect();
        changes.sort_by(f64::total_cmp);
        let least = ROUNDED * changes[changes.len() - 1];
        let steps = changes.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step| *step > least).min_by(f64::total_cmp)
    }

    /// The mean velocity over so many samples, around each sample as far as the run goes.
    fn means(&self, window: usize) -> impl Iterator<Item = f64> + '_ {
        let last = self.time.len().saturating_sub(1);
        let window = window.min(last);
        (0..self.time.len()).map(move |i| {
            let from = i.saturating_sub(window.div_ceil(2)).min(last - window);
            let to = from + window;
            (self.position[to] - self.position[from]) / (self.time[to] - self.time[from])
        })
    }

    /// The velocity as it was recorded, or the mean over a few samples.
    fn velocities(&self) -> Vec<f64> {
        match self.velocity.is_empty() {
            true => self.means(self.window()).collect(),
            false => self.velocity.clone(),
        }
    }

    /// The numbers of the picture.
    pub fn data(self) -> Data {
        let (velocity, clock) = (self.velocities(), self.clock);
        let rows = (0..self.time.len()).map(move |i| {
            let known = |column: &[f64]| Cell::from(column.get(i).copied());
            let limit = self.limit.get(i).map_or("", |limit| limit.as_str());
            let torques = [known(&self.torque), known(&self.hand_torque)];
            let motion = [self.time[i].into(), self.position[i].into(), known(&velocity)];
            motion.into_iter().chain(torques).chain([limit.into()]).collect()
        });
        match clock {
            Clock::Seconds => {
                Data::new(&["time", "position", "velocity", "torque", "hand", "limit"], rows)
            }
            Clock::Ticks => {
                Data::new(&["tick", "position", "velocity", "torque", "hand", "limit"], rows)
            }
        }
    }

    /// What limited the torque, each once.
    fn reasons(&self) -> Vec<(Served, Ground)> {
        let occurs = |served: &Served| self.limit.contains(served);
        let grounded = |served| Some((served, Ground::of(served)?));
        Served::all().filter(occurs).filter_map(grounded).collect()
    }
}

/// A step of the encoder is at most one in so many of the largest velocity.
const STEPS: f64 = 20.0;
/// A velocity is taken over at most one in so many of the samples.
const SMEARED: usize = 12;
/// Height of the line of the key that names the grounds, in pixels.
const ROW: i32 = 24;
/// Height of a line of words, in pixels.
const LINE: i32 = 20;
/// Letters of a line of words.
const LETTERS: usize = 112;
/// Heights of the panels, in pixels.
const PANELS: [i32; 3] = [226, 186, 264];
/// Which way is up.
const SIGNS: &str = "signs: angle, velocity and the hand's torque are positive in one direction; \
                     the motor applies minus the coupling torque";

/// Draws position above velocity and torque, over one time axis. Where the torque was limited or a
/// tick was missed, the ground says why. `wanted` are times and angles to be shown in place of all.
///
/// # Errors
/// Where there are fewer than two samples.
pub fn trace(trace: &Trace, wanted: &Window) -> Result<Picture, ChartError> {
    let samples = trace.time.len();
    if samples < 2 || trace.position.len() != samples || trace.torque.len() != samples {
        return Err(ChartError::TooFewPoints);
    }
    let reasons = trace.reasons();
    meets("horizontal", wanted.x.as_ref(), &trace.times())?;
    let times = wanted.x.clone().unwrap_or(trace.times());
    let seen = seen(&trace.position, trace, &times).chain(seen(&trace.hand, trace, &times));
    meets("vertical", wanted.y.as_ref(), &span(seen))?;
    let angles = wanted.y.clone().unwrap_or(angle_axis(trace, &times));
    let words = wrapped(&words(trace, &times, &angles));
    let key = LINE * words.len() as i32 + if reasons.is_empty() { 0 } else { ROW };
    let height = TITLE_ROOM + key + PANELS.iter().sum::<i32>() + LINE + 4;
    draw_sized((SIZE.0, height as u32), |area| {
        let area =
            area.margin(units(TOP), 0, 0, 0).titled(&shortened(&trace.title, 72), text(TITLE))?;
        let (above, area) = area.split_vertically(units(key));
        for (row, line) in words.iter().enumerate() {
            let place = (units(SIZE.0 as i32 / 2), units(LINE * row as i32 + LINE / 2));
            above.draw(&Text::new(line.clone(), place, anchored(HPos::Center, VPos::Center)))?;
        }
        let (_, grounds) = above.split_vertically(units(LINE * words.len() as i32));
        write_grounds(&grounds, &reasons)?;
        let (first, area) = area.split_vertically(units(PANELS[0]));
        let (second, area) = area.split_vertically(units(PANELS[1]));
        let (third, signs) = area.split_vertically(units(PANELS[2]));
        position(&first, trace, &times, &angles)?;
        velocity(&second, trace, &times)?;
        torque(&third, trace, &times, &reasons)?;
        let place = (units(SIZE.0 as i32 / 2), units(LINE / 2));
        let style = TextStyle::from((FONT, LABEL - units(2))).color(&BLACK);
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        signs.draw(&Text::new(SIGNS, place, style))
    })
}

/// The axis of the angle, unless another is asked for.
fn angle_axis(trace: &Trace, times: &Range<f64>) -> Range<f64> {
    let all = seen(&trace.position, trace, times).chain(seen(&trace.hand, trace, times));
    padded(span(all), 0.16)
}

fn position(area: &Area<'_>, trace: &Trace, times: &Range<f64>, y: &Range<f64>) -> Drawn<()> {
    let mut chart = panel(area, times, y, None, "angle (rad)")?;
    if let Some(face) = trace.face.filter(|face| y.contains(face)) {
        let line = [(times.start, face), (times.end, face)];
        chart.draw_series(broken(line, 2, 4, 1))?;
    }
    draw_in(&chart, trace, &trace.hand, HAND, 1)?;
    draw_in(&chart, trace, &trace.position, SOLID, 2)?;
    release(&mut chart, trace, times, y, true)
}

fn velocity(area: &Area<'_>, trace: &Trace, times: &Range<f64>) -> Drawn<()> {
    let velocity = trace.velocities();
    // One from angles has steps, which are small beside the velocity itself.
    let rest = trace.velocity.is_empty().then_some(0.0);
    let y = padded(span(seen(&velocity, trace, times).chain(rest)), 0.12);
    let name = match trace.clock {
        Clock::Seconds => "velocity (rad/s)",
        Clock::Ticks => "velocity (rad/tick)",
    };
    let mut chart = panel(area, times, &y, None, name)?;
    if y.contains(&0.0) {
        let zero = [(times.start, 0.0), (times.end, 0.0)];
        chart.draw_series([PathElement::new(zero, FAINT.stroke_width(UNITS))])?;
    }
    draw_in(&chart, trace, &velocity, SOLID, 1)?;
    release(&mut chart, trace, times, &y, false)
}

/// A panel with its axes.
fn panel<'a, 'b>(
    area: &'a Area<'b>,
    times: &Range<f64>,
    y: &Range<f64>,
    x: Option<&str>,
    name: &str,
) -> Drawn<Plane<'a, 'b>> {
    let below = if x.is_some() { X_LABELS } else { units(24) };
    let mut chart = axes::chart(area)
        .margin_top(units(8))
        .margin_bottom(units(2))
        .margin_right(MARGIN_RIGHT)
        .x_label_area_size(below)
        .build_cartesian_2d(times.clone(), y.clone())?;
    Axes { most: (11, 7), ..Axes::named(x, name) }.draw(&mut chart)?;
    Ok(chart)
}

/// A line through samples, as far as it is in the panel.
fn draw_in(
    chart: &Plane<'_, '_>,
    trace: &Trace,
    values: &[f64],
    dash: Dash,
    width: u32,
) -> Drawn<()> {
    let plot = chart.plotting_area();
    let (x, y) = (plot.get_x_range(), plot.get_y_range());
    let (w, h) = plot.dim_in_pixel();
    let part = |value: f64, range: &Range<f64>| (value - range.start) / (range.end - range.start);
    let place = |(time, value): (f64, f64)| {
        (part(time, &x) * f64::from(w), (1.0 - part(value, &y)) * f64::from(h))
    };
    let frame = Frame { left: 0.0, top: 0.0, right: f64::from(w), bottom: f64::from(h) };
    let places: Vec<_> = sampled(values, trace).into_iter().map(place).collect();
    let area = plot.strip_coord_spec();
    for line in Frame::clip(&places, |_| frame) {
        let line: Vec<_> = line.iter().map(whole).collect();
        dash.draw(&area, &line, width)?;
    }
    Ok(())
}

/// The samples at these times.
fn seen<'v>(
    values: &'v [f64],
    trace: &'v Trace,
    times: &'v Range<f64>,
) -> impl Iterator<Item = f64> + 'v {
    let both = trace.time.iter().zip(values);
    both.filter(|(time, _)| times.contains(*time)).map(|(_, value)| *value)
}

/// How the hand is drawn, and what the torque is limited to.
const HAND: Dash = Dash::new(&[6, 4]);
const LIMIT: Dash = Dash::new(&[12, 4, 2, 4]);

/// What the lines are, above the picture, where no curve can come in the way.
fn words(trace: &Trace, times: &Range<f64>, angles: &Range<f64>) -> Vec<String> {
    let mut words = vec!["solid: device".to_owned()];
    if let Some(face) = trace.face {
        words.push(match angles.contains(&face) {
            true => "dotted: face of the wall".to_owned(),
            false => {
                format!("face of the wall, {} rad, is outside of the picture", significant(face, 4))
            }
        });
    }
    if !trace.hand.is_empty() {
        words.push("broken: angle that the hand wants".to_owned());
    }
    if !trace.hand_torque.is_empty() {
        words.push("broken: torque of the hand".to_owned());
    }
    if let Some(limit) = trace.torque_limit {
        let limit = significant(limit, 4);
        words.push(match torque_axis(trace, times).1.is_empty() {
            false => format!("dash-dotted: torque limit, {limit} N m"),
            true => format!("torque limit {limit} N m is outside of the picture"),
        });
    }
    if trace.velocity.is_empty() {
        let few = match trace.window() {
            1 => "two ticks' angles".to_owned(),
            many => format!("angles {many} ticks apart"),
        };
        words.push(format!("velocity from {few}"));
    }
    if let Some(lost) = trace.lost {
        let unit = match trace.clock {
            Clock::Seconds => "s",
            Clock::Ticks => "ticks",
        };
        let when = significant(lost, 6);
        words.push(format!("not drawn from {when} {unit} on: too large for a picture"));
    }
    words
}

/// The words in lines that fit the picture.
fn wrapped(words: &[String]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if line.len() + word.len() + 2 <= LETTERS => {
                *line = format!("{line}; {word}");
            }
            _ => lines.push(word.clone()),
        }
    }
    lines
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

/// The axis of the torque, and the limits that are drawn along it.
fn torque_axis(trace: &Trace, times: &Range<f64>) -> (Range<f64>, Vec<f64>) {
    let torques = seen(&trace.torque, trace, times).chain(seen(&trace.hand_torque, trace, times));
    let range = span(torques);
    // The limit on the side that the torque is on, and on the other if that is used, too.
    let limits = trace.torque_limit.into_iter().flat_map(|limit| [limit, -limit]);
    let near = |limit: &f64| {
        let reached = if *limit > 0.0 { range.end } else { -range.start };
        reached > 0.2 * limit.abs()
    };
    let limits: Vec<f64> = limits.filter(near).collect();
    let y = padded(span([range.start, range.end].into_iter().chain(limits.iter().copied())), 0.12);
    (y, limits)
}

fn torque(
    area: &Area<'_>,
    trace: &Trace,
    times: &Range<f64>,
    reasons: &[(Served, Ground)],
) -> Drawn<()> {
    let (y, limits) = torque_axis(trace, times);
    let axis = match trace.clock {
        Clock::Seconds => "time (s)",
        Clock::Ticks => "time (ticks)",
    };
    let mut chart = panel(area, times, &y, Some(axis), "torque (N m)")?;
    for &(served, ground) in reasons {
        shade(&chart, trace, served, ground)?;
    }
    let level = |value: f64| [(times.start, value), (times.end, value)];
    if y.contains(&0.0) {
        chart.draw_series([PathElement::new(level(0.0), FAINT.stroke_width(UNITS))])?;
    }
    for limit in limits {
        let (plot, line) = (chart.plotting_area(), level(limit));
        let (x, y) = plot.get_base_pixel();
        let ends = line.map(|end| plot.map_coordinate(&end)).map(|(px, py)| (px - x, py - y));
        LIMIT.draw(&plot.strip_coord_spec(), &ends, 1)?;
    }
    draw_in(&chart, trace, &trace.hand_torque, HAND, 1)?;
    draw_in(&chart, trace, &trace.torque, SOLID, 2)?;
    release(&mut chart, trace, times, &y, false)
}

/// Covers the ground of the samples that were served so.
fn shade(chart: &Plane<'_, '_>, trace: &Trace, served: Served, ground: Ground) -> Drawn<()> {
    let plot = chart.plotting_area();
    let area = plot.strip_coord_spec();
    let (width, height) = area.dim_in_pixel();
    let (left, bottom) = (plot.get_base_pixel().0, plot.get_y_range().start);
    // A picture may show a part of the run.
    let times = plot.get_x_range();
    let place = |sample| {
        let time = trace.begin(sample).clamp(times.start, times.end);
        plot.map_coordinate(&(time, bottom)).0 - left
    };
    let first = trace.time.partition_point(|time| *time < times.start).saturating_sub(1);
    let last = trace.time.partition_point(|time| *time < times.end);
    for run in runs(&trace.limit[..last.min(trace.limit.len())], first, served, place) {
        ground.fill(&area, &(run.start..run.end.min(width as i32)), &(0..height as i32))?;
    }
    Ok(())
}

/// Where samples that were served so are, in units of the drawing: at least a pixel each, and one
/// where they are less than a pixel apart; those before the `first` left out.
fn runs(
    limit: &[Served],
    first: usize,
    served: Served,
    place: impl Fn(usize) -> i32,
) -> Vec<Range<i32>> {
    let mut runs: Vec<Range<i32>> = Vec::new();
    let samples = limit.iter().enumerate().skip(first);
    for (sample, _) in samples.filter(|(_, is)| **is == served) {
        let from = place(sample);
        let to = place(sample + 1).max(from + units(1));
        match runs.last_mut() {
            Some(run) if from < run.end + units(1) => run.end = to,
            _ => runs.push(from..to),
        }
    }
    runs
}

fn release(
    chart: &mut Plane<'_, '_>,
    trace: &Trace,
    times: &Range<f64>,
    y: &Range<f64>,
    named: bool,
) -> Drawn<()> {
    let Some(time) = trace.release.filter(|time| times.contains(time)) else { return Ok(()) };
    let line = [(time, y.start), (time, y.end)];
    chart.draw_series(broken(line, 8, 5, 1))?;
    if named {
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
        let wide = runs(&limit, 0, missed, |sample| units(10 * sample as i32));
        assert_eq!(wide, [units(10)..units(30), units(40)..units(50), units(80)..units(90)]);
        // Four samples a pixel.
        let narrow = runs(&limit, 0, missed, |sample| units(1) * sample as i32 / 4);
        assert_eq!((narrow.len(), &narrow[0]), (1, &(units(1) / 4..units(3))));
    }

    /// 4096 counts a turn, sent every other tick of 1 ms, around 0.3 rad/s.
    #[test]
    fn a_velocity_from_angles_is_no_comb_of_the_encoders_steps() {
        let step = std::f64::consts::TAU / 4096.0;
        let time: Vec<f64> = (0..1000).map(|i| 0.002 * f64::from(i)).collect();
        let angle = |t: &f64| (0.3 * t + 0.01 * (3.0 * t).sin()) / step;
        let position: Vec<f64> = time.iter().map(|t| angle(t).floor() * step).collect();
        let trace = Trace { time, position, ..Trace::default() };
        for (t, v) in trace.time.iter().zip(trace.velocities()) {
            let truth = 0.3 + 0.03 * (3.0 * t).cos();
            assert!((v - truth).abs() < 0.03, "{v} {truth} at {t}");
        }
        // Angles that no encoder has rounded are taken as near to each other as a picture shows.
        let position = trace.time.iter().map(|t| angle(t) * step).collect();
        assert_eq!(Trace { position, ..trace }.window(), 2);
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
