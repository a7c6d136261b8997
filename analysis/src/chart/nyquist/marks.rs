//! Frequencies along the curves, and the points of the margins.

use std::f64::consts::PI;

use plotters::prelude::*;

use super::{Curve, NyquistScene};
use crate::chart::labels::{Block, Labels};
use crate::chart::plot_area::{DrawingPoint, Frame, PlotArea, whole};
use crate::chart::{Drawn, LABEL, units};
use crate::quantity::significant;

/// Half the width of a frequency's mark and of a margin's.
const DOT: i32 = units(3);
const SQUARE: i32 = units(6);
/// Smallest distance of two marks.
const APART: f64 = units(46) as f64;
/// Marked frequencies in each decade.
const STEPS: [f64; 3] = [1.0, 2.0, 5.0];
/// Room on both sides of a curve.
const CLEAR: i32 = units(5);

/// Names other than frequencies.
pub(super) struct Names<'n> {
    /// The critical lines, with their names.
    pub(super) criticals: &'n [(f64, &'static str)],
    /// The points of least real part, with the numbers of their scenes.
    pub(super) minima: &'n [(DrawingPoint, String)],
    /// The ways through infinity.
    pub(super) ways: &'n [Vec<DrawingPoint>],
}

/// Marks frequencies inside a frame on the judged curve, and the point of its phase margin, and writes all
/// names beside curves and lines, if there is room.
pub(super) fn draw(
    plot: &PlotArea<'_>,
    scenes: &[NyquistScene],
    frame: Frame,
    names: &Names<'_>,
) -> Drawn<()> {
    let corners = [(frame.left, frame.top), (frame.right, frame.bottom)].map(|place| whole(&place));
    let mut labels = Labels::within(Block::new(corners[0], corners[1]));
    keep_clear_of_lines(plot, scenes, names, &mut labels);
    let judged = || scenes.iter().flat_map(judged_curves);
    for (scene, curve) in judged() {
        if let Some((_, _, value)) = scene.phase_margin(curve) {
            let (x, y) = whole(&plot.place(value));
            for (half, colour) in [(SQUARE, BLACK), (SQUARE - units(2), WHITE)] {
                let corners = [(x - half, y - half), (x + half, y + half)];
                plot.area.draw(&Rectangle::new(corners, colour.filled()))?;
            }
            labels.mark((x, y), SQUARE);
        }
    }
    let mut marked: Vec<(DrawingPoint, String)> = Vec::new();
    for (scene, curve) in judged() {
        for (hertz, place) in frequencies(plot, scene, curve) {
            let far = |(other, _): &(DrawingPoint, _)| {
                (other.0 - place.0).hypot(other.1 - place.1) >= APART
            };
            if frame.contains(place) && marked.iter().all(far) {
                plot.area.draw(&Circle::new(whole(&place), DOT, BLACK.filled()))?;
                marked.push((place, format!("{} Hz", significant(hertz, 3))));
            }
        }
    }
    let minima = names.minima.iter().map(|(value, number)| (plot.place(*value), number));
    let minima: Vec<_> = minima.map(|(place, number)| (whole(&place), number)).collect();
    minima.iter().for_each(|(point, _)| labels.mark(*point, SQUARE));
    marked.iter().for_each(|(place, _)| labels.mark(whole(place), DOT));
    name_lines(plot, scenes, names, &mut labels)?;
    for (point, number) in minima {
        labels.write(&plot.area, point, number, LABEL)?;
    }
    for (place, name) in marked {
        labels.write(&plot.area, whole(&place), &name, LABEL - units(2))?;
    }
    Ok(())
}

/// Keeps names off all lines and curves.
fn keep_clear_of_lines(
    plot: &PlotArea<'_>,
    scenes: &[NyquistScene],
    names: &Names<'_>,
    labels: &mut Labels,
) {
    let all = plot.all();
    let curves = || scenes.iter().flat_map(|scene| &scene.curves);
    let limits = scenes.iter().flat_map(|scene| [scene.limit, scene.bound]).flatten();
    let hairlines = curves().filter(|curve| curve.role.is_judged()).filter_map(|c| c.asymptote);
    let upright = limits.map(|value| -value).chain(hairlines).chain([0.0]);
    for x in upright.map(|value| plot.place((value, 0.0)).0) {
        if all.contains((x, 0.0)) {
            labels.keep_clear_along(whole(&(x, all.top)), whole(&(x, all.bottom)));
        }
    }
    let level = plot.place((0.0, 0.0)).1;
    if all.contains((0.0, level)) {
        labels.keep_clear_along(whole(&(all.left, level)), whole(&(all.right, level)));
    }
    for curve in curves() {
        let upper: Vec<_> = curve.values().map(|&value| plot.place(value)).collect();
        let lower: Vec<_> = upper.iter().map(|&place| plot.mirrored(place)).collect();
        for half in [upper, lower] {
            for part in Frame::clip(&half, |_| all) {
                labels.keep_clear_of(&part.iter().map(whole).collect::<Vec<_>>(), CLEAR);
            }
        }
    }
    for way in names.ways {
        labels.keep_clear_of(&way.iter().map(whole).collect::<Vec<_>>(), CLEAR);
    }
}

/// Names the critical lines from above, and the bounds from below.
fn name_lines(
    plot: &PlotArea<'_>,
    scenes: &[NyquistScene],
    names: &Names<'_>,
    labels: &mut Labels,
) -> Drawn<()> {
    let (all, x) = (plot.all(), |value: f64| plot.place((value, 0.0)).0);
    for (line, name) in names.criticals {
        let words = ["critical line".to_owned(), format!("{name} = {}", significant(*line, 4))];
        labels.write_along(&plot.area, x(*line).round() as i32, &words, (LABEL, true))?;
    }
    for (index, scene) in scenes.iter().enumerate() {
        let Some(line) = scene.bound.map(|bound| -bound) else { continue };
        if all.contains((x(line), 0.0)) {
            let number = if scenes.len() > 1 { format!("{}: ", index + 1) } else { String::new() };
            let words = [format!("{number}bound, {}", significant(line, 4))];
            labels.write_along(&plot.area, x(line).round() as i32, &words, (LABEL, false))?;
        }
    }
    Ok(())
}

/// The curves of a scene that are judged.
fn judged_curves(scene: &NyquistScene) -> impl Iterator<Item = (&NyquistScene, &Curve)> {
    let judged = scene.curves.iter().filter(|curve| curve.role.is_judged());
    judged.map(move |curve| (scene, curve))
}

/// Frequencies in Hz up to half the sample rate, round ones last, because the ends have priority.
fn frequencies(
    plot: &PlotArea<'_>,
    scene: &NyquistScene,
    curve: &Curve,
) -> Vec<(f64, DrawingPoint)> {
    let highest = 0.5 / scene.period;
    let decade = highest.log10().floor() as i32;
    let round = (0..6)
        .flat_map(|down| STEPS.iter().rev().map(move |step| step * 10_f64.powi(decade - down)));
    let points: Vec<_> = curve.points().collect();
    let at = |hertz: f64| {
        let theta = 2.0 * PI * hertz * scene.period;
        let after = points.partition_point(|point| point.0 < theta);
        let (after, before) = (points.get(after)?, points.get(after.checked_sub(1)?)?);
        let part = if after.0 > before.0 { (theta - before.0) / (after.0 - before.0) } else { 0.0 };
        let mix = |a: f64, b: f64| a + part * (b - a);
        let value = (mix(before.1.0, after.1.0), mix(before.1.1, after.1.1));
        (value.0.is_finite() && value.1.is_finite()).then(|| (hertz, plot.place(value)))
    };
    round.filter(|hertz| *hertz <= highest).filter_map(at).collect()
}
