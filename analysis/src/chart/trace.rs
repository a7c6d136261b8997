//! Position, velocity and torque over time.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::{Dash, SOLID};
use super::hatch::Fill;
use super::plot_area::{Frame, whole};
use super::*;
use crate::quantity::{shortened, significant};
use crate::simulation::tick_status::TickStatus;
use crate::trace::{TimeUnit, Trace};

/// Ends a run where it exceeds the range of a chart.
pub fn drawable(trace: Trace) -> Trace {
    trace.until(is_drawable)
}

/// The numbers of the chart.
pub fn data(trace: Trace) -> Data {
    let (velocity, time_unit) = (trace.velocities(), trace.time_unit);
    let rows = (0..trace.time.len()).map(move |i| {
        let known = |column: &[f64]| Cell::from(column.get(i).copied());
        let limit = trace.limit.get(i).map_or("", |limit| limit.as_str());
        let torques = [known(&trace.torque), known(&trace.hand_torque)];
        let motion = [trace.time[i].into(), trace.position[i].into(), known(&velocity)];
        motion.into_iter().chain(torques).chain([limit.into()]).collect()
    });
    match time_unit {
        TimeUnit::Seconds => {
            Data::new(&["time", "position", "velocity", "torque", "hand", "limit"], rows)
        }
        TimeUnit::Ticks => {
            Data::new(&["tick", "position", "velocity", "torque", "hand", "limit"], rows)
        }
    }
}

/// The reasons for limited torques, each once.
fn reasons(trace: &Trace) -> Vec<(TickStatus, Fill)> {
    let occurs = |status: &TickStatus| trace.limit.contains(status);
    let grounded = |status| Some((status, Fill::of(status)?));
    TickStatus::all().filter(occurs).filter_map(grounded).collect()
}

/// Height of the line of the legend that names the fills, in pixels.
const ROW: i32 = 24;
/// Height of a line of words, in pixels.
const LINE: i32 = 20;
/// Letters of a line of words.
const LETTERS: usize = 112;
/// Heights of the panels, in pixels.
const PANELS: [i32; 3] = [226, 186, 264];
/// The sign convention.
const SIGNS: &str = "signs: angle, velocity and the hand's torque are positive in one direction; \
                     the motor applies minus the coupling torque";

/// Draws position above velocity and torque, over one time axis. The fill shows why the torque was limited or
/// a tick was missed. `wanted` has the ranges of time and angle to show.
///
/// # Errors
/// If there are fewer than two samples.
pub fn trace(trace: &Trace, wanted: &Window) -> Result<Picture, ChartError> {
    let samples = trace.time.len();
    if samples < 2 || trace.position.len() != samples || trace.torque.len() != samples {
        return Err(ChartError::TooFewPoints);
    }
    let reasons = reasons(trace);
    meets("horizontal", wanted.x.as_ref(), &trace.times())?;
    let times = wanted.x.clone().unwrap_or(trace.times());
    let seen = seen(&trace.position, trace, &times).chain(seen(&trace.hand, trace, &times));
    meets("vertical", wanted.y.as_ref(), &span(seen))?;
    let angles = wanted.y.clone().unwrap_or(angle_axis(trace, &times));
    let words = wrapped(&words(trace, &times, &angles));
    let legend = LINE * words.len() as i32 + if reasons.is_empty() { 0 } else { ROW };
    let height = TITLE_ROOM + legend + PANELS.iter().sum::<i32>() + LINE + 4;
    draw_sized((SIZE.0, height as u32), |area| {
        let area =
            area.margin(units(TOP), 0, 0, 0).titled(&shortened(&trace.title, 72), text(TITLE))?;
        let (above, area) = area.split_vertically(units(legend));
        for (row, line) in words.iter().enumerate() {
            let place = (units(SIZE.0 as i32 / 2), units(LINE * row as i32 + LINE / 2));
            above.draw(&Text::new(line.clone(), place, anchored(HPos::Center, VPos::Center)))?;
        }
        let (_, grounds) = above.split_vertically(units(LINE * words.len() as i32));
        write_fill_legend(&grounds, &reasons)?;
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

/// The default axis of the angle.
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
    // A velocity from angles has steps, which are small compared with the velocity itself.
    let rest = trace.velocity.is_empty().then_some(0.0);
    let y = padded(span(seen(&velocity, trace, times).chain(rest)), 0.12);
    let name = match trace.time_unit {
        TimeUnit::Seconds => "velocity (rad/s)",
        TimeUnit::Ticks => "velocity (rad/tick)",
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

/// The line styles of the hand and of the torque limit.
const HAND: Dash = Dash::new(&[6, 4]);
const LIMIT: Dash = Dash::new(&[12, 4, 2, 4]);

/// The explanation of the lines, above the chart, where no curve is in the way.
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
        words.push("dashed: set-point of the hand".to_owned());
    }
    if !trace.hand_torque.is_empty() {
        words.push("dashed: torque of the hand".to_owned());
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
        let unit = match trace.time_unit {
            TimeUnit::Seconds => "s",
            TimeUnit::Ticks => "ticks",
        };
        let when = significant(lost, 6);
        words.push(format!("not drawn from {when} {unit} on: too large for a chart"));
    }
    words
}

/// The text in lines that fit the picture.
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

/// The legend of the torque's fills, side by side.
fn write_fill_legend(area: &Area<'_>, reasons: &[(TickStatus, Fill)]) -> Drawn<()> {
    const SWATCH: i32 = 30;
    const GAP: i32 = 8;
    // An estimate of the text's width.
    let width = |name: &str| SWATCH + 3 * GAP + 7 * name.len() as i32;
    let all: i32 = reasons.iter().map(|(status, _)| width(name(*status))).sum();
    let mut x = (SIZE.0 as i32 - all) / 2;
    for &(status, fill) in reasons {
        fill.swatch(area, &(units(x)..units(x + SWATCH)), &(units(4)..units(ROW - 4)))?;
        let place = (units(x + SWATCH + GAP), units(ROW / 2));
        let style = anchored(HPos::Left, VPos::Center);
        area.draw(&Text::new(name(status), place, style))?;
        x += width(name(status));
    }
    Ok(())
}

/// The meaning of a fill.
fn name(status: TickStatus) -> &'static str {
    use haptic_servo::torque::LimitReason::{
        Angle, DacRange, Heat, None, NotANumber, Ramp, Torque,
    };
    match status {
        TickStatus::Ran(None) => "not limited",
        TickStatus::Ran(Torque) => "torque limit",
        TickStatus::Ran(DacRange) => "converter limit",
        TickStatus::Ran(Angle) => "angle out of range",
        TickStatus::Ran(NotANumber) => "not a number",
        TickStatus::Ran(Ramp) => "fading in or out",
        TickStatus::Ran(Heat) => "heat limit",
        TickStatus::Missed => "tick missed",
    }
}

/// The axis of the torque, and the drawn limits.
fn torque_axis(trace: &Trace, times: &Range<f64>) -> (Range<f64>, Vec<f64>) {
    let torques = seen(&trace.torque, trace, times).chain(seen(&trace.hand_torque, trace, times));
    let range = span(torques);
    // The limit on the side of the torque, and on the other side if that is also used.
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
    reasons: &[(TickStatus, Fill)],
) -> Drawn<()> {
    let (y, limits) = torque_axis(trace, times);
    let axis = match trace.time_unit {
        TimeUnit::Seconds => "time (s)",
        TimeUnit::Ticks => "time (ticks)",
    };
    let mut chart = panel(area, times, &y, Some(axis), "torque (N m)")?;
    for &(status, fill) in reasons {
        shade(&chart, trace, status, fill)?;
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

/// Fills the background of the samples of this status.
fn shade(chart: &Plane<'_, '_>, trace: &Trace, status: TickStatus, fill: Fill) -> Drawn<()> {
    let plot = chart.plotting_area();
    let area = plot.strip_coord_spec();
    let (width, height) = area.dim_in_pixel();
    let (left, bottom) = (plot.get_base_pixel().0, plot.get_y_range().start);
    // A chart may show a part of the run.
    let times = plot.get_x_range();
    let place = |sample| {
        let time = trace.begin(sample).clamp(times.start, times.end);
        plot.map_coordinate(&(time, bottom)).0 - left
    };
    let first = trace.time.partition_point(|time| *time < times.start).saturating_sub(1);
    let last = trace.time.partition_point(|time| *time < times.end);
    for run in runs(&trace.limit[..last.min(trace.limit.len())], first, status, place) {
        fill.draw(&area, &(run.start..run.end.min(width as i32)), &(0..height as i32))?;
    }
    Ok(())
}

/// The intervals of samples with this status, in units of the drawing: at least a pixel each, joined if they
/// are less than a pixel apart; without those before `first`.
fn runs(
    limit: &[TickStatus],
    first: usize,
    status: TickStatus,
    place: impl Fn(usize) -> i32,
) -> Vec<Range<i32>> {
    let mut runs: Vec<Range<i32>> = Vec::new();
    let samples = limit.iter().enumerate().skip(first);
    for (sample, _) in samples.filter(|(_, is)| **is == status) {
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

/// Largest number of visible parts of a curve.
const PARTS: usize = 2000;

/// The samples as points. If there are too many, each part's ends, minimum and maximum.
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
    fn samples_of_one_reason_are_one_fill_and_none_is_lost() {
        let [ran, missed] = [TickStatus::UNLIMITED, TickStatus::Missed];
        let limit = [ran, missed, missed, ran, missed, ran, ran, ran, missed];
        let wide = runs(&limit, 0, missed, |sample| units(10 * sample as i32));
        assert_eq!(wide, [units(10)..units(30), units(40)..units(50), units(80)..units(90)]);
        // Four samples a pixel.
        let narrow = runs(&limit, 0, missed, |sample| units(1) * sample as i32 / 4);
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
