//! The part of the plane that shows the judged curves and bounds.

use std::ops::Range;

use super::{Curve, NyquistScene, Role};

/// The critical lines, at minus the largest index that passes, each once and from the left, with their names.
pub fn critical_lines(scenes: &[NyquistScene]) -> Vec<(f64, &'static str)> {
    let line = |scene: &NyquistScene| Some((-scene.limit?, scene.limit_name));
    let mut lines: Vec<_> = scenes.iter().filter_map(line).collect();
    lines.sort_by(|a, b| a.0.total_cmp(&b.0));
    lines.dedup_by_key(|line| line.0);
    lines
}

/// Ranges of the two axes that show the judged curves and bounds; a range that is given stays.
pub fn usual_window(
    scenes: &[NyquistScene],
    wanted_x: Option<Range<f64>>,
    wanted_y: Option<Range<f64>>,
) -> (Range<f64>, Range<f64>) {
    let curves = || scenes.iter().flat_map(|scene| &scene.curves);
    let is_endless = |curve: &Curve| !curve.poles.is_empty();
    let endless = curves().any(is_endless);
    let lines = critical_lines(scenes).into_iter().map(|line| line.0);
    let bounds = scenes.iter().filter_map(|scene| Some(-scene.bound?));
    // Near a pole away from z = 1 the curve may go to infinity in any direction; it is cut off far
    // beyond the critical line. So are the curves that the verdict does not use.
    let limits = scenes.iter().filter_map(|scene| scene.limit.or(scene.bound));
    let far = 8.0 * limits.fold(f64::MIN_POSITIVE, f64::max);
    let askew = curves().flat_map(|curve| &curve.poles).any(|pole| pole.residue().is_none());
    let seen = curves().flat_map(|curve| {
        let cut = askew || curve.role == Role::Alone;
        curve.values().map(|point| point.0).filter(move |re| !cut || re.abs() <= far)
    });
    let right = span(seen.chain(lines).chain(bounds).chain([0.0]));
    // Room on the left for the name of the critical line.
    let width = right.end - right.start;
    // More on the right if a curve closes through infinity.
    let ways = curves().flat_map(|curve| &curve.poles).filter(|pole| pole.is_simple());
    let room = [0.1, 0.16 + 0.015 * ways.clone().count() as f64][usize::from(ways.count() > 0)];
    let usual = right.start - 0.3 * width..right.end + room * width;
    let x = wanted_x.unwrap_or(usual);
    let finite = curves().filter(|curve| !is_endless(curve));
    let tallest = span(finite.flat_map(|curve| curve.values()).map(|p| p.1.abs()));
    let height = if endless {
        // The curve has no end; a height like the width is enough to see its direction.
        (1.2 * (x.end - x.start)).max(1.1 * tallest.end)
    } else {
        (1.3 * tallest.end).max(0.1 * width)
    };
    (x, wanted_y.unwrap_or(-height..height))
}

/// Whether a value can be on an axis: small enough that ranges do not overflow.
pub fn is_drawable(value: f64) -> bool {
    value.abs() <= 1e300
}

/// The range of the values that can be on an axis; from zero to zero if there are none.
pub fn span(values: impl Iterator<Item = f64>) -> Range<f64> {
    let mut finite = values.filter(|value| is_drawable(*value));
    let first = finite.next().unwrap_or(0.0);
    finite.fold(first..first, |range, value| range.start.min(value)..range.end.max(value))
}
