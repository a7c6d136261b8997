//! The paper's Nyquist plots: `(T z / (z - 1)) E(z)` and the line that it must not cross.

mod infinity;
mod key;
mod sheet;

use std::f64::consts::PI;

use firmware::certificate::{Assessment, Loop, Rule, assess};
use firmware::scene::Scene;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::Dash;
use super::*;
use crate::circle::{CirclePole, poles};
use crate::minimum::least;
use crate::quantity::{shortened, significant};
use crate::response::Response;

use sheet::{Frame, Place, Sheet};

/// Points between two poles on half the unit circle. They are denser towards the poles, where the
/// curve is longest.
const POINTS: usize = 1600;

/// A line that is hardly there.
const HAIRLINE: Dash = Dash::new(&[1, 7]);

/// Nearest to a pole that the curve is drawn, in rad.
const NEAREST: f64 = 1e-3;

/// Longest title, in letters.
const LONGEST_TITLE: usize = 72;

/// An environment to draw, in one pattern of dashes.
struct Curve {
    name: String,
    /// For angles from nearly 0 to pi, cut where there are poles.
    branches: Vec<Branch>,
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

/// The part of a curve between two poles, or from or to the real axis.
struct Branch {
    /// Numbers of the poles at its ends, where there are poles.
    poles: [Option<usize>; 2],
    /// Real and imaginary part at rising angles.
    values: Vec<(f64, f64)>,
}

impl Curve {
    /// Real and imaginary parts along the curve.
    fn values(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.branches.iter().flat_map(|branch| &branch.values)
    }
}

/// Draws the Nyquist plots of the environments of named scenes for velocity,
/// `(T z / (z - 1)) E(z)`, with the critical lines at `-delta` and each curve's minimum marked.
/// Where a pole on the unit circle takes a curve to infinity, a broken line along the frame shows
/// on which side it comes back.
///
/// # Errors
/// Where an environment has no transfer function, or there is none.
pub fn nyquist(title: &str, scenes: &[(String, Scene)]) -> Result<Picture, ChartError> {
    if scenes.is_empty() {
        return Err(ChartError::TooFewPoints);
    }
    let curves: Result<Vec<_>, _> = scenes.iter().map(|(name, scene)| curve(name, scene)).collect();
    let curves = curves?;
    let key = key::height(&curves);
    let size = (SIZE.0, SIZE.1 + key as u32 / UNITS);
    draw_sized(size, |area| {
        let area = area
            .margin(units(TOP), 0, 0, 0)
            .titled(&shortened(title, LONGEST_TITLE), text(TITLE))?;
        let (plot, below) = area.split_vertically(units(size.1 as i32) - key - units(TITLE_ROOM));
        paint(&plot, &curves)?;
        key::write(&below, &curves)
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
        branches: branches(&poles, point),
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

/// The curve between the poles.
fn branches(poles: &[CirclePole], point: impl Fn(f64) -> (f64, f64)) -> Vec<Branch> {
    let at = |theta: f64| (theta, poles.iter().position(|pole| pole.theta == theta));
    let inner = poles.iter().map(|pole| pole.theta).filter(|theta| *theta > 0.0 && *theta < PI);
    let cuts: Vec<_> = [0.0].into_iter().chain(inner).chain([PI]).map(at).collect();
    let between = |pair: &[(f64, Option<usize>)]| Branch {
        poles: [pair[0].1, pair[1].1],
        values: angles(pair[0].0, pair[1].0).map(&point).collect(),
    };
    cuts.windows(2).map(between).collect()
}

/// Angles from one to another, logarithmic towards both.
fn angles(from: f64, to: f64) -> impl Iterator<Item = f64> {
    let length = to - from;
    let half = move |index: usize| {
        (NEAREST / PI).powf(1.0 - index as f64 / (POINTS / 2) as f64) * 0.5 * length
    };
    let up = (0..POINTS / 2).map(move |index| from + half(index));
    let down = (0..=POINTS / 2).rev().map(move |index| from + length - half(index));
    up.chain(down).chain((to == PI).then_some(PI))
}

fn paint(area: &Area<'_>, curves: &[Curve]) -> Drawn<()> {
    let (x, y) = window(curves);
    let mut chart = axes::chart(area).build_cartesian_2d(x.clone(), y.clone())?;
    let lines = critical_lines(curves);
    // What lies left of all the lines is forbidden whatever the scene.
    let leftmost = lines.iter().copied().fold(f64::INFINITY, f64::min);
    let forbidden = Rectangle::new([(x.start, y.start), (leftmost, y.end)], FORBIDDEN.filled());
    chart.draw_series([forbidden])?;
    Axes::named("real part (N m s/rad)", "imaginary part (N m s/rad)").draw(&mut chart)?;
    let axes = [vec![(x.start, 0.0), (x.end, 0.0)], vec![(0.0, y.start), (0.0, y.end)]];
    chart.draw_series(axes.map(|axis| PathElement::new(axis, pen(1))))?;
    for &line in &lines {
        chart.draw_series(broken([(line, y.start), (line, y.end)], 8, 5, 2))?;
    }
    let sheet = Sheet::of(&chart);
    let frames = infinity::frames(&sheet, curves);
    let mut ways = Vec::new();
    for (index, (curve, frames)) in curves.iter().zip(&frames).enumerate() {
        ways.extend(draw_curve(&sheet, curve, Dash::of(index), frames)?);
    }
    infinity::name(&sheet, &ways)?;
    let top = infinity::below(&sheet, &frames);
    for (row, &line) in lines.iter().enumerate() {
        name_line(&mut chart, line, top - 0.15 * row as f64, &x, &y)?;
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
    let points = || curves.iter().flat_map(|curve| curve.values());
    let lines = curves.iter().map(|curve| -curve.delta);
    // Near a pole that is not at rest the curve may go to infinity in any direction; what is far
    // beyond the critical line is cut off.
    let far = 8.0 * curves.iter().map(|curve| curve.delta).fold(f64::MIN_POSITIVE, f64::max);
    let askew = curves.iter().flat_map(|curve| &curve.poles).any(|pole| pole.residue().is_none());
    let seen = points().map(|point| point.0).filter(|re| !askew || re.abs() <= far);
    let right = span(seen.chain(lines).chain([0.0]));
    // Room on the left for the name of the critical line.
    let width = right.end - right.start;
    // More on the right where there is infinity.
    let ways = curves.iter().flat_map(|curve| &curve.poles).filter(|pole| infinity::is_drawn(pole));
    let room = [0.1, 0.16 + 0.015 * ways.clone().count() as f64][usize::from(ways.count() > 0)];
    let x = right.start - 0.3 * width..right.end + room * width;
    let finite = curves.iter().filter(|curve| !is_endless(curve));
    let tallest = span(finite.flat_map(|curve| curve.values()).map(|p| p.1.abs()));
    let height = if endless {
        // The curve has no end; as much of it as is wide is enough to see where it goes.
        (1.2 * (x.end - x.start)).max(1.1 * tallest.end)
    } else {
        (1.3 * tallest.end).max(0.1 * width)
    };
    (x, -height..height)
}

/// Writes the name of a critical line on ground of its own, where curves may pass behind it; `top`
/// is a part of the upper half's height.
fn name_line(
    chart: &mut Plane<'_, '_>,
    line: f64,
    top: f64,
    x: &Range<f64>,
    y: &Range<f64>,
) -> Drawn<()> {
    let width = x.end - x.start;
    let right = line - 0.012 * width;
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

/// The curve, and in a thinner line its mirror image for negative angles, with arrows in the
/// direction of rising angles; what it tends to at rest, where it goes to infinity, in a hairline;
/// and its ways through infinity, which are given back.
fn draw_curve(
    sheet: &Sheet<'_>,
    curve: &Curve,
    dash: Dash,
    frames: &[Frame],
) -> Drawn<Vec<Vec<Place>>> {
    if let Some(re) = curve.asymptote {
        let (x, all) = (sheet.place((re, 0.0)).0, sheet.all());
        sheet.line(HAIRLINE, &[(x, all.top), (x, all.bottom)], 1)?;
    }
    for branch in &curve.branches {
        let [first, last] = branch.poles.map(|pole| {
            let drawn = pole.filter(|&pole| infinity::is_drawn(&curve.poles[pole]));
            drawn.map_or(sheet.all(), |pole| frames[pole])
        });
        let places: Vec<_> = branch.values.iter().map(|&value| sheet.place(value)).collect();
        let half = places.len() / 2;
        let parts = Frame::clip(&places, |place| if place < half { first } else { last });
        let longest = parts.iter().max_by_key(|part| part.len());
        if let Some(part) = longest {
            let mirrored: Vec<_> = part.iter().rev().map(|&place| sheet.mirrored(place)).collect();
            sheet.arrow(part, 0.4)?;
            sheet.arrow(&mirrored, 0.6)?;
        }
        for part in &parts {
            let mirrored: Vec<_> = part.iter().map(|&place| sheet.mirrored(place)).collect();
            sheet.line(dash, part, 2)?;
            sheet.line(dash, &mirrored, 1)?;
        }
    }
    infinity::draw(sheet, curve, frames)
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
        let (left, bottom) = (re + 0.02 * width, im + 0.06 * height);
        // On ground of its own, where curves may pass behind it.
        let right = left + (0.004 + 0.0115 * label.len() as f64) * width;
        let ground = [(left - 0.004 * width, bottom), (right, bottom + 0.08 * height)];
        chart.draw_series([Rectangle::new(ground, WHITE.filled())])?;
        chart.draw_series([Text::new(
            label,
            (left, bottom + 0.04 * height),
            anchored(HPos::Left, VPos::Center),
        )])?;
    }
    Ok(())
}
