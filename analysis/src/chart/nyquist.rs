//! The paper's Nyquist plots: `(T z / (z - 1)) E(z)` and the line that it must not cross.

use std::f64::consts::PI;

use firmware::certificate::{Assessment, Loop, Rule, assess};
use firmware::scene::Scene;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::dash::Dash;
use super::*;
use crate::circle::{CirclePole, Kind, poles};
use crate::minimum::least;
use crate::quantity::{shortened, significant};
use crate::response::Response;

/// Points between two poles on half the unit circle. They are denser towards the poles, where the
/// curve is longest.
const POINTS: usize = 1600;

/// Nearest to a pole that the curve is drawn, in rad.
const NEAREST: f64 = 1e-3;

/// Height of a line of the key in pixels.
const ROW: i32 = 19;

/// An environment to draw, in one pattern of dashes.
struct Curve {
    name: String,
    /// Real and imaginary part for angles from nearly 0 to pi, cut where there are poles.
    branches: Vec<Vec<(f64, f64)>>,
    poles: Vec<CirclePole>,
    /// Real part that the curve has near its pole at rest.
    asymptote: Option<f64>,
    /// Where the real part is least; `None` where it is the same all around.
    minimum: Option<(f64, f64)>,
    /// Passivity of the device, the critical line being at minus that.
    delta: f64,
    alpha: Option<f64>,
    /// What is judged where it is not the curve that is drawn.
    judged: Option<String>,
}

/// Draws the Nyquist plots of the environments of named scenes for velocity,
/// `(T z / (z - 1)) E(z)`, with the critical lines at `-delta` and each curve's minimum marked.
/// Where a pole on the unit circle takes a curve to infinity, the key says on which side it comes
/// back.
///
/// # Errors
/// Where an environment has no transfer function, or there is none.
pub fn nyquist(title: &str, scenes: &[(String, Scene)]) -> Result<Picture, ChartError> {
    if scenes.is_empty() {
        return Err(ChartError::TooFewPoints);
    }
    let curves: Result<Vec<_>, _> = scenes.iter().map(|(name, scene)| curve(name, scene)).collect();
    let curves = curves?;
    let key = units(ROW * rows(&curves) + 10);
    let size = (SIZE.0, SIZE.1 + key as u32 / UNITS);
    draw_sized(size, |area| {
        let area = area
            .margin(units(TOP), 0, 0, 0)
            .titled(&shortened(title, LONGEST_TITLE), text(TITLE))?;
        let (plot, below) = area.split_vertically(units(size.1 as i32) - key - units(TITLE_ROOM));
        paint(&plot, &curves)?;
        write_key(&below, &curves)
    })
}

fn curve(name: &str, scene: &Scene) -> Result<Curve, ChartError> {
    let transfers =
        Loop::of(scene).map_err(|why| ChartError::NoTransfer { scene: name.to_owned(), why })?;
    let velocity = Response::new(transfers.environment).from_velocity(scene.timing.period);
    let poles = poles(velocity.transfer());
    let assessment = assess(scene);
    let point = |theta: f64| {
        let value = velocity.at_angle(theta);
        (value.re, value.im)
    };
    let minimum = least(|theta| velocity.at_angle(theta).re, 0.0, PI);
    Ok(Curve {
        name: name.to_owned(),
        branches: branches(&poles)
            .into_iter()
            .map(|angles| angles.into_iter().map(point).collect())
            .collect(),
        asymptote: poles
            .first()
            .filter(|pole| pole.theta == 0.0 && pole.residue().is_some())
            .map(|_| point(1e-3).0),
        poles,
        minimum: minimum.map(|theta| point(theta.max(1e-3))),
        delta: assessment.delta.midpoint(),
        alpha: assessment.alpha.map(|alpha| alpha.midpoint()),
        judged: judged(&assessment),
    })
}

/// Where the verdict does not rest on the curve alone: a bound, or the coupling taken in.
fn judged(assessment: &Assessment) -> Option<String> {
    let (name, index) = match assessment.rule {
        Rule::Nonlinear => ("one-sided or limited: judged by the bound", assessment.bound?),
        Rule::Exact if assessment.alpha == assessment.alpha_coupled => return None,
        Rule::Exact => ("judged with its coupling taken in", assessment.alpha_coupled?),
    };
    Some(format!("{name}, alpha = {} N m s/rad", significant(index.midpoint(), 4)))
}

/// Angles between the poles.
fn branches(poles: &[CirclePole]) -> Vec<Vec<f64>> {
    let inner = poles.iter().map(|pole| pole.theta).filter(|theta| *theta > 0.0 && *theta < PI);
    let cuts: Vec<f64> = std::iter::once(0.0).chain(inner).chain([PI]).collect();
    let between = |pair: &[f64]| {
        let (from, length) = (pair[0], pair[1] - pair[0]);
        // Logarithmic towards both ends.
        let half = |index: usize| {
            (NEAREST / PI).powf(1.0 - index as f64 / (POINTS / 2) as f64) * 0.5 * length
        };
        let up = (0..POINTS / 2).map(|index| from + half(index));
        let down = (0..=POINTS / 2).rev().map(|index| from + length - half(index));
        up.chain(down).chain((pair[1] == PI).then_some(PI)).collect()
    };
    cuts.windows(2).map(between).collect()
}

fn paint(area: &Area<'_>, curves: &[Curve]) -> Drawn<()> {
    let (x, y) = window(curves);
    let mut chart = ChartBuilder::on(area)
        .margin(MARGIN)
        .x_label_area_size(X_LABELS)
        .y_label_area_size(Y_LABELS)
        .build_cartesian_2d(x.clone(), y.clone())?;
    let lines = critical_lines(curves);
    // What lies left of all the lines is forbidden whatever the scene.
    let leftmost = lines.iter().copied().fold(f64::INFINITY, f64::min);
    let forbidden = Rectangle::new([(x.start, y.start), (leftmost, y.end)], FORBIDDEN.filled());
    chart.draw_series([forbidden])?;
    mesh(&mut chart, Some("real part (N m s/rad)"), "imaginary part (N m s/rad)")?;
    let axes = [vec![(x.start, 0.0), (x.end, 0.0)], vec![(0.0, y.start), (0.0, y.end)]];
    chart.draw_series(axes.map(|axis| PathElement::new(axis, pen(1))))?;
    for &line in &lines {
        chart.draw_series(broken([(line, y.start), (line, y.end)], 8, 5, 2))?;
    }
    for (index, curve) in curves.iter().enumerate() {
        draw_curve(&mut chart, curve, Dash::of(index), &y)?;
    }
    for (row, &line) in lines.iter().enumerate() {
        name_line(&mut chart, line, row, &x, &y)?;
    }
    label_minima(&mut chart, curves, &x, y.end)
}

/// The lines at `-delta`, each once.
fn critical_lines(curves: &[Curve]) -> Vec<f64> {
    let mut lines: Vec<f64> = curves.iter().map(|curve| -curve.delta).collect();
    lines.sort_by(f64::total_cmp);
    lines.dedup();
    lines
}

/// Ranges of the axes.
fn window(curves: &[Curve]) -> (Range<f64>, Range<f64>) {
    let is_endless = |curve: &Curve| !curve.poles.is_empty();
    let endless = curves.iter().any(is_endless);
    let points = || curves.iter().flat_map(|curve| curve.branches.iter().flatten());
    let lines = curves.iter().map(|curve| -curve.delta);
    // Near a pole that is not at rest the curve may go to infinity in any direction; what is far
    // beyond the critical line is cut off.
    let far = 8.0 * curves.iter().map(|curve| curve.delta).fold(f64::MIN_POSITIVE, f64::max);
    let askew = curves.iter().flat_map(|curve| &curve.poles).any(|pole| pole.residue().is_none());
    let seen = points().map(|point| point.0).filter(|re| !askew || re.abs() <= far);
    let right = span(seen.chain(lines).chain([0.0]));
    // Room on the left for the name of the critical line.
    let width = right.end - right.start;
    let x = right.start - 0.3 * width..right.end + 0.1 * width;
    let finite = curves.iter().filter(|curve| !is_endless(curve));
    let tallest = span(finite.flat_map(|curve| curve.branches.iter().flatten()).map(|p| p.1.abs()));
    let height = if endless {
        // The curve has no end; as much of it as is wide is enough to see where it goes.
        (1.2 * (x.end - x.start)).max(1.1 * tallest.end)
    } else {
        (1.3 * tallest.end).max(0.1 * width)
    };
    (x, -height..height)
}

/// Writes the name of a critical line on ground of its own, where curves may pass behind it.
fn name_line(
    chart: &mut Plane<'_, '_>,
    line: f64,
    row: usize,
    x: &Range<f64>,
    y: &Range<f64>,
) -> Drawn<()> {
    let width = x.end - x.start;
    let right = line - 0.012 * width;
    let top = 0.99 - 0.15 * row as f64;
    let ground =
        [(right + 0.004 * width, y.end * top), (right - 0.125 * width, y.end * (top - 0.14))];
    chart.draw_series([Rectangle::new(ground, FORBIDDEN.filled())])?;
    let names = ["critical line".to_owned(), format!("-delta = {}", significant(line, 4))];
    for (part, name) in names.into_iter().enumerate() {
        let place = (right, y.end * (top - 0.04 - 0.07 * part as f64));
        chart.draw_series([Text::new(name, place, anchored(HPos::Right, VPos::Center))])?;
    }
    Ok(())
}

/// The curve, and in a thinner line its mirror image for negative angles; what it tends to at
/// rest, where it goes to infinity, in a hairline.
fn draw_curve(chart: &mut Plane<'_, '_>, curve: &Curve, dash: Dash, y: &Range<f64>) -> Drawn<()> {
    if let Some(re) = curve.asymptote {
        chart.draw_series(broken([(re, y.start), (re, y.end)], 1, 7, 1))?;
    }
    let area = chart.plotting_area();
    let (left, top) = (area.get_x_range(), y.clone());
    for branch in &curve.branches {
        for (sign, width) in [(1.0, 2), (-1.0, 1)] {
            // Cut where the curve leaves the picture.
            let inside = |&(re, im): &(f64, f64)| left.contains(&re) && top.contains(&im);
            for piece in branch.split(|point| !inside(point)).filter(|piece| piece.len() > 1) {
                let place = |&(re, im): &(f64, f64)| area.map_coordinate(&(re, sign * im));
                let points: Vec<_> = piece.iter().map(place).collect();
                dash.draw(&area.strip_coord_spec(), &local(area, points), width)?;
            }
        }
    }
    Ok(())
}

/// From the drawing's units to those of an area of it.
fn local(
    area: &DrawingArea<SVGBackend<'_>, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    points: Vec<(i32, i32)>,
) -> Vec<(i32, i32)> {
    let (x, y) = area.get_base_pixel();
    points.into_iter().map(|point| (point.0 - x, point.1 - y)).collect()
}

/// Marks the minima; what is said about several at one place stands in a row.
fn label_minima(
    chart: &mut Plane<'_, '_>,
    curves: &[Curve],
    x: &Range<f64>,
    height: f64,
) -> Drawn<()> {
    let width = x.end - x.start;
    let near = |a: (f64, f64), b: (f64, f64)| {
        (a.0 - b.0).abs() < 0.04 * width && (a.1 - b.1).abs() < 0.1 * height
    };
    let mut labels: Vec<((f64, f64), String)> = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        let Some(alpha) = curve.alpha else { continue };
        let at = curve.minimum.filter(|point| point.1.abs() <= height).unwrap_or((-alpha, 0.0));
        chart.draw_series([
            Circle::new(at, units(5), WHITE.filled()),
            Circle::new(at, units(5), pen(2)),
        ])?;
        // What is said about a curve alone stands in the key, where nothing crosses it.
        if curves.len() == 1 {
            continue;
        }
        if let Some((_, numbers)) = labels.iter_mut().find(|(other, _)| near(*other, at)) {
            *numbers += &format!(", {}", index + 1);
        } else {
            labels.push((at, (index + 1).to_string()));
        }
    }
    for ((re, im), label) in labels {
        // Above the axis, where the mirrored half of the curve leaves the point to the right.
        let place = (re + 0.02 * width, im + 0.06 * height);
        chart.draw_series([Text::new(label, place, anchored(HPos::Left, VPos::Bottom))])?;
    }
    Ok(())
}

fn least_words(curve: &Curve) -> &'static str {
    if curve.minimum.is_some() { "least real part, -alpha" } else { "real part everywhere, -alpha" }
}

/// Lines that the key has.
fn rows(curves: &[Curve]) -> i32 {
    key(curves).iter().map(|(_, lines)| lines.len() as i32).sum()
}

/// What is written below the picture, with the pattern that it is about.
fn key(curves: &[Curve]) -> Vec<(Dash, Vec<String>)> {
    let entry = |(index, curve): (usize, &Curve)| {
        let alpha = curve.alpha.map_or_else(
            || "no alpha: its poles forbid it".to_owned(),
            |alpha| format!("{} = {} N m s/rad", least_words(curve), significant(-alpha, 4)),
        );
        let mut lines = if curves.len() > 1 {
            vec![format!("{}: {}: {alpha}", index + 1, shortened(&curve.name, LONGEST_NAME))]
        } else {
            let mark = if curve.alpha.is_some() { "circle: " } else { "" };
            let halves = "thick: angles from 0 to pi; thin: from -pi to 0";
            vec![halves.to_owned(), format!("{mark}{alpha}")]
        };
        lines.extend(curve.poles.iter().map(sentence));
        if let Some(re) = curve.asymptote {
            let re = significant(re, 3);
            lines.push(format!("hairline of dots: its real part near rest, {re} N m s/rad"));
        }
        lines.extend(curve.judged.clone());
        (Dash::of(index), lines)
    };
    curves.iter().enumerate().map(entry).collect()
}

/// Longest title, in letters.
const LONGEST_TITLE: usize = 72;
/// Longest name in the key, in letters.
const LONGEST_NAME: usize = 48;

/// What a pole does to the curve.
fn sentence(pole: &CirclePole) -> String {
    let place = match pole.theta {
        0.0 => "pole at rest, z = 1".to_owned(),
        PI => "pole at z = -1".to_owned(),
        theta => format!("poles at +-{} rad", significant(theta, 4)),
    };
    match (pole.residue(), pole.kind) {
        (Some(k), _) if k > 0.0 => format!(
            "{place}: residue {} N m s/rad > 0, closes through infinity on the right: allowed",
            significant(k, 4)
        ),
        (Some(k), _) => format!(
            "{place}: residue {} N m s/rad < 0, closes through infinity on the left: not passive",
            significant(k, 4)
        ),
        (None, Kind::Repeated) => format!("{place}: repeated: not passive"),
        (None, Kind::Simple(_)) => {
            format!("{place}: residue of the wrong angle, goes to infinity askew: not passive")
        }
    }
}

fn write_key(area: &Area<'_>, curves: &[Curve]) -> Drawn<()> {
    let mut row = 0;
    for (dash, lines) in key(curves) {
        for (index, line) in lines.into_iter().enumerate() {
            let middle = units(ROW * row + ROW / 2);
            if index == 0 {
                dash.draw(area, &[(units(20), middle), (units(76), middle)], 2)?;
            }
            let style = anchored(HPos::Left, VPos::Center);
            area.draw(&Text::new(line, (units(88), middle), style))?;
            row += 1;
        }
    }
    Ok(())
}
