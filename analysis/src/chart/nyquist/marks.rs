//! Frequencies along the curves, and the points of the margins.

use std::f64::consts::PI;

use plotters::prelude::*;

use super::{Curve, Judged};
use crate::chart::labels::{Block, Labels};
use crate::chart::sheet::{Frame, Place, Sheet, whole};
use crate::chart::{Drawn, LABEL, UNITS, units};
use crate::quantity::significant;

/// Half the width of a frequency's mark and of a margin's.
const DOT: i32 = units(3);
const SQUARE: i32 = units(6);
/// Two marks are at least so far apart.
const APART: f64 = units(46) as f64;
/// Frequencies that are marked, in each decade.
const STEPS: [f64; 3] = [1.0, 2.0, 5.0];
/// Pieces of a curve that names keep clear of.
const PIECES: usize = 60;

/// Marks frequencies inside of a frame on what is judged, and where its phase margin is reached.
///
/// Names keep clear of what is `written` already: corners of rectangles.
pub(super) fn draw(
    sheet: &Sheet<'_>,
    scenes: &[Judged],
    frame: Frame,
    written: &[[(f64, f64); 2]],
) -> Drawn<()> {
    let all = sheet.all();
    let corner = whole(&(all.right, all.bottom));
    let mut labels = Labels::within(Block::new((0, 0), corner));
    let judged = || scenes.iter().flat_map(judged_curves);
    for corners in written {
        let [from, to] = corners.map(|corner| whole(&sheet.place(corner)));
        labels.keep_clear_along(from, to);
    }
    let origin = sheet.place((0.0, 0.0));
    let lines = scenes.iter().filter_map(|scene| Some(sheet.place((-scene.limit?, 0.0)).0));
    for x in lines.chain([origin.0]).filter(|x| all.contains((*x, 0.0))) {
        labels.keep_clear_along(whole(&(x, all.top)), whole(&(x, all.bottom)));
    }
    if all.contains((0.0, origin.1)) {
        labels.keep_clear_along(whole(&(all.left, origin.1)), whole(&(all.right, origin.1)));
    }
    for (_, curve) in judged() {
        keep_clear(sheet, curve, &mut labels);
    }
    let mut taken: Vec<Place> = Vec::new();
    for (scene, curve) in judged() {
        if let Some((_, _, value)) = scene.phase_margin(curve) {
            let (x, y) = whole(&sheet.place(value));
            for (half, colour) in [(SQUARE, BLACK), (SQUARE - units(2), WHITE)] {
                let corners = [(x - half, y - half), (x + half, y + half)];
                sheet.area.draw(&Rectangle::new(corners, colour.filled()))?;
            }
        }
        for (hertz, place) in frequencies(sheet, scene, curve) {
            let far = |other: &Place| (other.0 - place.0).hypot(other.1 - place.1) >= APART;
            if !frame.contains(place) || !taken.iter().all(far) {
                continue;
            }
            taken.push(place);
            let style = BLACK.filled();
            sheet.area.draw(&Circle::new(whole(&place), DOT, style))?;
            let name = format!("{} Hz", significant(hertz, 3));
            labels.write(&sheet.area, whole(&place), &name, LABEL - units(2))?;
        }
    }
    Ok(())
}

/// The curves of a scene that are judged.
fn judged_curves(scene: &Judged) -> impl Iterator<Item = (&Judged, &Curve)> {
    let judged = scene.curves.iter().filter(|curve| curve.role.is_judged());
    judged.map(move |curve| (scene, curve))
}

/// Lets no name be on a curve or its mirror image.
fn keep_clear(sheet: &Sheet<'_>, curve: &Curve, labels: &mut Labels) {
    let mut last: Option<Place> = None;
    for &(re, im) in curve.values() {
        let place = sheet.place((re, im));
        let step = sheet.all().right / PIECES as f64;
        let moved = last.is_none_or(|last| (last.0 - place.0).hypot(last.1 - place.1) > step);
        if moved && sheet.all().contains(place) {
            labels.keep_clear(whole(&place), UNITS as i32 * 6);
            labels.keep_clear(whole(&sheet.mirrored(place)), UNITS as i32 * 6);
            last = Some(place);
        }
    }
}

/// Frequencies in Hz up to half the sample rate, the round ones last: they give way to the ends.
fn frequencies(sheet: &Sheet<'_>, scene: &Judged, curve: &Curve) -> Vec<(f64, Place)> {
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
        (value.0.is_finite() && value.1.is_finite()).then(|| (hertz, sheet.place(value)))
    };
    round.filter(|hertz| *hertz <= highest).filter_map(at).collect()
}
