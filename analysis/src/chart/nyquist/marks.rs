//! Frequencies along the curves, and the points of the margins.

use std::f64::consts::PI;

use super::{Curve, NyquistScene};
use crate::chart::frame::{Place, whole};
use crate::chart::labels::{Block, Labels};
use crate::chart::mark::Mark;
use crate::chart::panel::Panel;
use crate::chart::{Drawn, units};
use crate::quantity::significant;

/// Smallest distance of two marks.
const APART: f64 = units(46) as f64;
/// Marked frequencies in each decade.
const STEPS: [f64; 3] = [1.0, 2.0, 5.0];
/// Room on both sides of a curve.
const CLEAR: i32 = units(5);

/// Marks frequencies on the judged curve, and the point of its phase margin, and writes their
/// names, if there is room beside curves and lines. `minima` are the points of least real part, with the
/// numbers of their scenes.
pub(super) fn draw(
    panel: &Panel<'_, '_>,
    scenes: &[NyquistScene],
    minima: &[((f64, f64), String)],
) -> Drawn<()> {
    let end = whole(&(panel.frame.right, panel.frame.bottom));
    let mut labels = Labels::within(Block::new((0, 0), end));
    keep_clear_of_lines(panel, scenes, &mut labels);
    let judged =
        || scenes.iter().flat_map(|scene| scene.judged_curves().map(move |curve| (scene, curve)));
    for (scene, curve) in judged() {
        if let Some((_, _, value)) = scene.phase_margin(curve) {
            panel.mark(Mark::FRAME, value)?;
            labels.mark(panel.point(value), Mark::FRAME.reach());
        }
    }
    let mut marked: Vec<(Place, String)> = Vec::new();
    for (scene, curve) in judged() {
        for (hertz, place) in frequencies(panel, scene, curve) {
            let far =
                |(other, _): &(Place, _)| (other.0 - place.0).hypot(other.1 - place.1) >= APART;
            if panel.frame.contains(place) && marked.iter().all(far) {
                Mark::DOT.draw(&panel.area, whole(&place))?;
                marked.push((place, format!("{} Hz", significant(hertz, 3))));
            }
        }
    }
    let minima = minima.iter().map(|(value, number)| (panel.point(*value), number, Mark::RING));
    let marked = marked.iter().map(|(place, name)| (whole(place), name, Mark::DOT));
    let named: Vec<_> = minima.chain(marked).collect();
    named.iter().for_each(|(point, _, mark)| labels.mark(*point, mark.reach()));
    named.iter().try_for_each(|(point, name, _)| labels.write(&panel.area, *point, name))
}

/// Keeps names off all lines and curves.
fn keep_clear_of_lines(panel: &Panel<'_, '_>, scenes: &[NyquistScene], labels: &mut Labels) {
    let all = panel.frame;
    let curves = || scenes.iter().flat_map(|scene| &scene.curves);
    let limits = scenes.iter().flat_map(|scene| [scene.limit, scene.bound]).flatten();
    let judged = scenes.iter().flat_map(NyquistScene::judged_curves);
    let hairlines = judged.filter_map(|curve| curve.asymptote);
    let upright = limits.map(|value| -value).chain(hairlines).chain([0.0]);
    for x in upright.map(|value| panel.place((value, 0.0)).0) {
        if all.contains((x, 0.0)) {
            labels.keep_clear_along(whole(&(x, 0.0)), whole(&(x, all.bottom)));
        }
    }
    let level = panel.place((0.0, 0.0)).1;
    if all.contains((0.0, level)) {
        labels.keep_clear_along(whole(&(0.0, level)), whole(&(all.right, level)));
    }
    for curve in curves() {
        let upper: Vec<_> = curve.values().map(|&value| panel.place(value)).collect();
        let lower: Vec<_> = upper.iter().map(|&place| panel.mirrored(place)).collect();
        for half in [upper, lower] {
            for part in all.clip(&half) {
                labels.keep_clear_of(&part.iter().map(whole).collect::<Vec<_>>(), CLEAR);
            }
        }
    }
}

/// Frequencies in Hz up to half the sample rate, round ones last, because the ends have priority.
fn frequencies(panel: &Panel<'_, '_>, scene: &NyquistScene, curve: &Curve) -> Vec<(f64, Place)> {
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
        (value.0.is_finite() && value.1.is_finite()).then(|| (hertz, panel.place(value)))
    };
    round.filter(|hertz| *hertz <= highest).filter_map(at).collect()
}
