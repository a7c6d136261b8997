//! The open loop over frequency: gain above phase, with the margins to -1 marked.

use super::*;
use crate::open_loop::{Margin, OpenLoop};
use crate::quantity::{shortened, significant};

/// Heights of the panels in pixels.
const PANELS: [i32; 2] = [270, 280];
/// Longest name in the legend, in letters.
const LONGEST_NAME: usize = 40;
/// Decades above and below a gain of 1 by default.
const DECADES: f64 = 3.0;
const MARGIN: Stroke = Stroke::dashed(&[3, 3], 2);
/// The level from which margins are measured.
const LEVEL: Stroke = Stroke::solid(1).faint();

/// Draws the open loops of named scenes; `wanted` are the ranges of frequency in Hz and of gain, above 0.
pub fn bode(
    title: &str,
    loops: &[(String, OpenLoop)],
    wanted: &Window,
) -> Result<Picture, ChartError> {
    let points = || loops.iter().flat_map(|(_, found)| &found.points);
    let all = span(points().map(|point| point.hertz));
    if all.start >= all.end || all.start <= 0.0 {
        return Err(ChartError::TooFewPoints);
    }
    meets("horizontal", wanted.x.as_ref(), &all)?;
    meets("vertical", wanted.y.as_ref(), &span(points().map(|point| point.gain)))?;
    let x = wanted.x.clone().unwrap_or_else(|| interesting(loops, &all));
    // The last point is at half the sample rate, where the phase falls fastest.
    let seen = || points().filter(|point| (x.start..=x.end).contains(&point.hertz));
    let far = 10_f64.powf(DECADES);
    let gains = seen().map(|point| point.gain.clamp(1.0 / far, far));
    let gains = span(gains.chain([1.0]));
    let gains = wanted.y.clone().unwrap_or(gains.start / 2.0..gains.end * 2.0);
    let phases = padded(span(seen().map(|point| point.phase).chain([-180.0])), 0.06);
    let hertz = |name| Axis::logarithmic(x.clone(), name);
    let (gains, phases) =
        (Axis::logarithmic(gains, "gain (1)"), Axis::linear(phases, "phase (degrees)"));
    let lines = (0..).map(|index| Sample::Line(Stroke::of(index, 2)));
    Page::new(title, &PANELS).legend(1, lines.zip(words(loops))).draw(|areas| {
        let gains = Panel::new(&areas[0], hertz(""), gains)?;
        let phases = Panel::new(&areas[1], hertz("frequency (Hz)"), phases)?;
        gains.level(LEVEL, 1.0)?;
        phases.level(LEVEL, -180.0)?;
        for (index, (_, found)) in loops.iter().enumerate() {
            let stroke = Stroke::of(index, 2);
            gains.curve(stroke, found.points.iter().map(|point| (point.hertz, point.gain)))?;
            phases.curve(stroke, found.points.iter().map(|point| (point.hertz, point.phase)))?;
            for margin in found.nearest_gain_margins() {
                mark(&gains, margin.hertz, [1.0, 1.0 / margin.value])?;
            }
            if let Some(margin) = found.phase_margin() {
                let phase = phase_at(found, margin.hertz);
                mark(&phases, margin.hertz, [phase, phase - margin.value])?;
            }
        }
        Ok(())
    })
}

/// The frequencies around the margins, a decade to each side and more.
fn interesting(loops: &[(String, OpenLoop)], all: &Range<f64>) -> Range<f64> {
    let margins = loops
        .iter()
        .flat_map(|(_, found)| found.nearest_gain_margins().chain(found.phase_margin()));
    let lowest = margins.map(|margin| margin.hertz).fold(all.end, f64::min);
    (lowest / 30.0).clamp(all.start, all.end / 100.0)..all.end
}

/// The phase next to a frequency.
fn phase_at(found: &OpenLoop, hertz: f64) -> f64 {
    let next = found.points.partition_point(|point| point.hertz < hertz);
    found.points.get(next).map_or(-180.0, |point| point.phase)
}

/// A margin between two values, with a dot at each that is in the panel.
fn mark(panel: &Panel<'_, '_>, hertz: f64, values: [f64; 2]) -> Drawn<()> {
    let ends = values.map(|value| (hertz, value));
    let places = ends.map(|end| panel.frame.nearest(panel.place(end)));
    if panel.frame.contains((panel.place(ends[0]).0, 0.0)) {
        panel.line(MARGIN, &places)?;
    }
    ends.into_iter().try_for_each(|end| panel.mark(Mark::DOT, end))
}

/// The margins of the loops, one line for each loop.
pub fn words(loops: &[(String, OpenLoop)]) -> Vec<String> {
    let of = |(name, found): &(String, OpenLoop)| {
        let at = |margin: Margin| format!("at {} Hz", significant(margin.hertz, 3));
        let decibels = |factor: f64| significant(20.0 * factor.log10(), 3);
        let factor = |margin: Margin| {
            let (value, db) = (significant(margin.value, 4), decibels(margin.value));
            format!("gain margin {value} ({db} dB) {}", at(margin))
        };
        let mut words: Vec<_> = found.nearest_gain_margins().map(factor).collect();
        if words.is_empty() {
            words.push("no gain margin: the phase is never -180 degrees".to_owned());
        }
        words.push(found.phase_margin().map_or_else(
            || "no phase margin: the gain is never 1".to_owned(),
            |margin| {
                format!("phase margin {} degrees {}", significant(margin.value, 3), at(margin))
            },
        ));
        let fate = if found.is_stable { "stable" } else { "UNSTABLE" };
        format!("{}: {fate}; {}", shortened(name, LONGEST_NAME), words.join("; "))
    };
    loops.iter().map(of).collect()
}

pub fn data(loops: Vec<(String, OpenLoop)>) -> Data {
    let rows = loops.into_iter().flat_map(|(name, found)| {
        found.points.into_iter().map(move |point| {
            vec![(&*name).into(), point.hertz.into(), point.gain.into(), point.phase.into()]
        })
    });
    Data::new("scene,frequency (Hz),gain (1),phase (degrees)", rows)
}
