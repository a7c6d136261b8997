//! Position, velocity and torque over time.

use super::*;
use crate::quantity::significant;
use crate::simulation::tick_status::TickStatus;
use crate::trace::{TimeUnit, Trace};

/// Ends a run where it exceeds the range of a chart.
pub fn drawable(trace: Trace) -> Trace {
    trace.until(is_drawable)
}

pub fn data(trace: Trace) -> Data {
    let (velocity, time_unit) = (trace.velocities(), trace.time_unit);
    let rows = (0..trace.time.len()).map(move |i| {
        let known = |column: &[f64]| Cell::from(column.get(i).copied());
        let limit = trace.limit.get(i).map_or("", |limit| limit.as_str());
        let torques = [known(&trace.torque), known(&trace.hand_torque)];
        let motion = [trace.time[i].into(), trace.position[i].into(), known(&velocity)];
        motion.into_iter().chain(torques).chain([limit.into()]).collect()
    });
    let time = if time_unit == TimeUnit::Ticks { "tick" } else { "time" };
    Data::new(format!("{time},position,velocity,torque,hand,limit"), rows)
}

/// The reasons for limited torques, each once, with their fills and meanings.
fn reasons(trace: &Trace) -> Vec<(TickStatus, Fill, &'static str)> {
    let occurs = |status: &TickStatus| trace.limit.contains(status);
    let reason = |status| Fill::of(status).map(|(fill, words)| (status, fill, words));
    TickStatus::all().filter(occurs).filter_map(reason).collect()
}

/// Heights of the panels, in pixels.
const PANELS: [i32; 3] = [216, 186, 256];
/// The sign convention.
const SIGNS: &str = "signs: angle, velocity and the hand's torque are positive in one direction; \
                     the motor applies minus the coupling torque";
/// The lines of the device, of its velocity, of the hand, of a wall's face, of the torque limit, of the
/// moment at which the hand lets go, and of zero.
const DEVICE: Stroke = Stroke::solid(2);
const VELOCITY: Stroke = Stroke::solid(1);
const HAND: Stroke = Stroke::dashed(&[6, 4], 1);
const FACE: Stroke = Stroke::dashed(&[2, 4], 1);
const LIMIT: Stroke = Stroke::dashed(&[12, 4, 2, 4], 1);
const RELEASE: Stroke = Stroke::dashed(&[12, 4, 2, 4, 2, 4], 1);
const ZERO: Stroke = Stroke::solid(1).faint();

/// Draws position above velocity and torque, over one time axis. The fill shows why the torque was limited or
/// a tick was missed. `wanted` has the ranges of time and angle to show.
pub fn trace(trace: &Trace, wanted: &Window) -> Result<Picture, ChartError> {
    let samples = trace.time.len();
    if samples < 2 || trace.position.len() != samples || trace.torque.len() != samples {
        return Err(ChartError::TooFewPoints);
    }
    meets("horizontal", wanted.x.as_ref(), &trace.times())?;
    let times = wanted.x.clone().unwrap_or(trace.times());
    let seen = || seen(&trace.position, trace, &times).chain(seen(&trace.hand, trace, &times));
    meets("vertical", wanted.y.as_ref(), &span(seen()))?;
    let angles = wanted.y.clone().unwrap_or(padded(span(seen()), 0.16));
    let reasons = reasons(trace);
    let fills = reasons.iter().map(|(_, fill, words)| (Sample::Region(*fill), (*words).into()));
    let lines = lines(trace, &times, &angles).into_iter();
    let notes = notes(trace).into_iter().map(|note| (Sample::Nothing, note));
    let page = Page::new(&trace.title, &PANELS).legend(2, lines.chain(fills)).legend(1, notes);
    page.draw(|areas| {
        position(&areas[0], trace, &times, angles)?;
        velocity(&areas[1], trace, &times)?;
        torque(&areas[2], trace, &times, &reasons)
    })
}

fn position(area: &Area<'_>, trace: &Trace, times: &Range<f64>, y: Range<f64>) -> Drawn<()> {
    let y = Axis::linear(y, "angle (rad)");
    let panel = Panel::new(area, Axis::linear(times.clone(), ""), y)?;
    if let Some(face) = trace.face {
        panel.level(FACE, face)?;
    }
    panel.curve(HAND, sampled(&trace.hand, trace))?;
    panel.curve(DEVICE, sampled(&trace.position, trace))?;
    release(&panel, trace)
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
    let panel = Panel::new(area, Axis::linear(times.clone(), ""), Axis::linear(y, name))?;
    panel.level(ZERO, 0.0)?;
    panel.curve(VELOCITY, sampled(&velocity, trace))?;
    release(&panel, trace)
}

/// The line at which the hand lets go.
fn release(panel: &Panel<'_, '_>, trace: &Trace) -> Drawn<()> {
    trace.release.map_or(Ok(()), |time| panel.upright(RELEASE, time))
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

fn lines(trace: &Trace, times: &Range<f64>, angles: &Range<f64>) -> Vec<(Sample, String)> {
    let mut lines = vec![(Sample::Line(DEVICE), "device".to_owned())];
    // A level, which may be outside of its panel.
    let mut level = |is_seen: bool, stroke: Stroke, words: String| {
        lines.push(Sample::Line(stroke).entry(is_seen, words));
    };
    if let Some(face) = trace.face {
        let words = format!("face of the wall, {} rad", significant(face, 4));
        level(angles.contains(&face), FACE, words);
    }
    if let Some(limit) = trace.torque_limit {
        let words = format!("torque limit, {} N m", significant(limit, 4));
        level(!torque_axis(trace, times).1.is_empty(), LIMIT, words);
    }
    if let Some(time) = trace.release.filter(|time| times.contains(time)) {
        let words = format!("the hand lets go, at {} {}", significant(time, 4), unit(trace));
        level(true, RELEASE, words);
    }
    let hands =
        [(&trace.hand, "set-point of the hand"), (&trace.hand_torque, "torque of the hand")];
    for (_, words) in hands.into_iter().filter(|hand| !hand.0.is_empty()) {
        level(true, HAND, words.to_owned());
    }
    lines
}

fn notes(trace: &Trace) -> Vec<String> {
    let velocity = trace.velocity.is_empty().then(|| match trace.window() {
        1 => "velocity from two ticks' angles".to_owned(),
        many => format!("velocity from angles {many} ticks apart"),
    });
    let lost = trace.lost.map(|lost| {
        let when = significant(lost, 6);
        format!("not drawn from {when} {} on: too large for a chart", unit(trace))
    });
    [velocity, lost, Some(SIGNS.to_owned())].into_iter().flatten().collect()
}

fn unit(trace: &Trace) -> &'static str {
    match trace.time_unit {
        TimeUnit::Seconds => "s",
        TimeUnit::Ticks => "ticks",
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
    reasons: &[(TickStatus, Fill, &str)],
) -> Drawn<()> {
    let (y, limits) = torque_axis(trace, times);
    let x = match trace.time_unit {
        TimeUnit::Seconds => "time (s)",
        TimeUnit::Ticks => "time (ticks)",
    };
    let x = Axis::linear(times.clone(), x);
    let panel = Panel::new(area, x, Axis::linear(y, "torque (N m)"))?;
    for &(status, fill, _) in reasons {
        shade(&panel, trace, times, (status, fill))?;
    }
    panel.level(ZERO, 0.0)?;
    limits.into_iter().try_for_each(|limit| panel.level(LIMIT, limit))?;
    panel.curve(HAND, sampled(&trace.hand_torque, trace))?;
    panel.curve(DEVICE, sampled(&trace.torque, trace))?;
    release(&panel, trace)
}

/// Fills the background of the samples of this status. A chart may show a part of the run.
fn shade(
    panel: &Panel<'_, '_>,
    trace: &Trace,
    times: &Range<f64>,
    (status, fill): (TickStatus, Fill),
) -> Drawn<()> {
    let [width, height] = [panel.frame.right, panel.frame.bottom].map(|end| end as i32);
    let place = |sample| panel.point((trace.begin(sample).clamp(times.start, times.end), 0.0)).0;
    let first = trace.time.partition_point(|time| *time < times.start).saturating_sub(1);
    let last = trace.time.partition_point(|time| *time < times.end);
    for run in runs(&trace.limit[..last.min(trace.limit.len())], first, status, place) {
        fill.draw(&panel.area, &(run.start..run.end.min(width)), &(0..height))?;
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
