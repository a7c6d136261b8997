//! The paper's Nyquist plots: the judged transfer function of a scene, and the line that it must not cross.

mod infinity;
mod legend;
mod marks;

use haptic_servo::scene::Scene;
use plotters::prelude::*;

use super::axes::Axes;
use super::dash::Dash;
use super::plot_area::{DrawingPoint, Frame, PlotArea};
use super::*;
use crate::nyquist::{Curve, NyquistScene, Role, critical_lines, usual_window};
use crate::quantity::shortened;

/// A very light line.
const HAIRLINE: Dash = Dash::new(&[1, 7]);

/// Longest title, in letters.
const LONGEST_TITLE: usize = 72;

/// A curve with its line pattern.
struct Line<'j> {
    dash: Dash,
    curve: &'j Curve,
}

impl Line<'_> {
    fn ink(&self) -> RGBColor {
        if self.curve.role.is_judged() { BLACK } else { FAINT }
    }
}

/// Each judged curve takes a pattern; the others take the pattern of their scene.
fn lines(scenes: &[NyquistScene]) -> Vec<Vec<Line<'_>>> {
    let mut used = 0;
    let mut of = |scene: &'_ NyquistScene| -> Vec<usize> {
        let first = used;
        let number = |curve: &Curve| match curve.role {
            Role::Alone => first,
            _ => {
                used += 1;
                used - 1
            }
        };
        scene.curves.iter().map(number).collect()
    };
    let line = |(curve, dash): (_, usize)| Line { dash: Dash::of(dash), curve };
    let numbers: Vec<Vec<usize>> = scenes.iter().map(&mut of).collect();
    scenes.iter().zip(numbers).map(|(s, n)| s.curves.iter().zip(n).map(line).collect()).collect()
}

/// Draws the Nyquist plots of named scenes for velocity, `(T z / (z - 1)) G`: the judged curve in black, with
/// its critical line, its least real part and frequencies marked; and, in grey, the environment alone if it
/// differs. If a pole on the unit circle takes a curve to infinity, a broken line along the frame shows the
/// side of its closure.
///
/// # Errors
/// If an environment has no transfer function, or there is no scene.
pub fn nyquist(
    title: &str,
    scenes: &[(String, Scene)],
    wanted: &Window,
) -> Result<Picture, ChartError> {
    if scenes.is_empty() {
        return Err(ChartError::TooFewPoints);
    }
    let scenes = judged(scenes)?;
    let values = || scenes.iter().flat_map(|scene| &scene.curves).flat_map(Curve::values);
    let lines = critical_lines(&scenes).into_iter().map(|line| line.0);
    let bounds = scenes.iter().filter_map(|scene| Some(-scene.bound?));
    let real = span(values().map(|value| value.0).chain(lines).chain(bounds));
    let tallest = span(values().map(|value| value.1.abs())).end;
    meets("horizontal", wanted.x.as_ref(), &real)?;
    meets("vertical", wanted.y.as_ref(), &(-tallest..tallest))?;
    let legend = legend::height(&scenes);
    let size = (SIZE.0, SIZE.1 + legend as u32 / UNITS);
    draw_sized(size, |area| {
        let area = area
            .margin(units(TOP), 0, 0, 0)
            .titled(&shortened(title, LONGEST_TITLE), text(TITLE))?;
        let (plot, below) =
            area.split_vertically(units(size.1 as i32) - legend - units(TITLE_ROOM));
        paint(&plot, &scenes, wanted)?;
        legend::write(&below, &scenes)
    })
}

fn judged(scenes: &[(String, Scene)]) -> Result<Vec<NyquistScene>, ChartError> {
    scenes.iter().map(|(name, scene)| Ok(NyquistScene::of(name, scene)?)).collect()
}

/// The curves as numbers, at rising angles from 0 to the Nyquist frequency.
///
/// # Errors
/// If an environment has no transfer function.
pub fn data(scenes: &[(String, Scene)]) -> Result<Data, ChartError> {
    let rows = judged(scenes)?.into_iter().flat_map(|scene| {
        let NyquistScene { name, period, curves, limit, bound, .. } = scene;
        curves.into_iter().flat_map(move |curve| {
            let (name, role) = (name.clone(), curve.role.as_str());
            let line = limit.map(|limit| -limit);
            let bound = bound.map(|bound| -bound);
            let points: Vec<_> = curve.points().collect();
            points.into_iter().map(move |(theta, (re, im))| {
                let frequency = theta / (2.0 * std::f64::consts::PI * period);
                vec![
                    (&*name).into(),
                    role.into(),
                    theta.into(),
                    frequency.into(),
                    re.into(),
                    im.into(),
                    line.into(),
                    bound.into(),
                ]
            })
        })
    });
    Ok(Data::new(
        &[
            "scene",
            "curve",
            "angle (rad)",
            "frequency (Hz)",
            "real part (N m s/rad)",
            "imaginary part (N m s/rad)",
            "critical line (N m s/rad)",
            "bound (N m s/rad)",
        ],
        rows,
    ))
}

fn paint(area: &Area<'_>, scenes: &[NyquistScene], wanted: &Window) -> Drawn<()> {
    let (x, y) = usual_window(scenes, wanted.x.clone(), wanted.y.clone());
    let mut chart = axes::chart(area).build_cartesian_2d(x.clone(), y.clone())?;
    let criticals = critical_lines(scenes);
    // The region left of all lines is forbidden for every scene; without any line, the whole plane.
    let leftmost = criticals.first().map_or(x.end, |line| line.0.clamp(x.start, x.end));
    let forbidden = Rectangle::new([(x.start, y.start), (leftmost, y.end)], FORBIDDEN.filled());
    chart.draw_series([forbidden])?;
    Axes::named("real part (N m s/rad)", "imaginary part (N m s/rad)").draw(&mut chart)?;
    if y.contains(&0.0) {
        chart.draw_series([PathElement::new([(x.start, 0.0), (x.end, 0.0)], pen(1))])?;
    }
    if x.contains(&0.0) {
        chart.draw_series([PathElement::new([(0.0, y.start), (0.0, y.end)], pen(1))])?;
    }
    let shown: Vec<_> = criticals.into_iter().filter(|line| x.contains(&line.0)).collect();
    for (line, _) in &shown {
        chart.draw_series(broken([(*line, y.start), (*line, y.end)], 8, 5, 2))?;
    }
    let plot = PlotArea::of(&chart);
    let patterns = lines(scenes);
    let through: Vec<_> = scenes.iter().flat_map(|s| &s.curves).collect();
    let frames = infinity::frames(&plot, &through);
    let mut ways = Vec::new();
    for (line, frames) in patterns.iter().flatten().zip(&frames) {
        ways.extend(draw_curve(&plot, line, frames)?);
    }
    draw_bounds(&mut chart, scenes, &x, &y)?;
    infinity::name(&plot, &ways)?;
    let minima = draw_minima(&mut chart, scenes, &x, y.end)?;
    let inner = frames.iter().flatten().last().copied().unwrap_or(plot.all());
    let names = marks::Names { criticals: &shown, minima: &minima, ways: &ways };
    marks::draw(&plot, scenes, inner, &names)
}

/// The bound that is judged in place of a curve: a vertical line, with all motion of the scene on its right.
fn draw_bounds(
    chart: &mut Plane<'_, '_>,
    scenes: &[NyquistScene],
    x: &Range<f64>,
    y: &Range<f64>,
) -> Drawn<()> {
    let bounds = scenes.iter().filter_map(|scene| Some(-scene.bound?));
    for line in bounds.filter(|line| x.contains(line)) {
        let style = BLACK.stroke_width(3 * UNITS);
        chart.draw_series([PathElement::new([(line, y.start), (line, y.end)], style)])?;
    }
    Ok(())
}

/// The curve, and in a thinner line its mirror image for negative angles, with arrows in the direction of
/// rising angles; its asymptote at rest, if it goes to infinity, as a hairline; and its closures at infinity,
/// which are returned.
fn draw_curve(
    plot: &PlotArea<'_>,
    line: &Line<'_>,
    frames: &[Frame],
) -> Drawn<Vec<Vec<DrawingPoint>>> {
    let Line { dash, curve } = line;
    let judged = curve.role.is_judged();
    if let Some(re) = curve.asymptote.filter(|_| judged) {
        let (x, all) = (plot.place((re, 0.0)).0, plot.all());
        if all.left <= x && x <= all.right {
            plot.line(HAIRLINE, &[(x, all.top), (x, all.bottom)], 1)?;
        }
    }
    for branch in &curve.branches {
        let [first, last] = branch.poles.map(|pole| {
            let drawn = pole.filter(|&pole| curve.poles[pole].is_simple());
            drawn.map_or(plot.all(), |pole| frames[pole])
        });
        let places: Vec<_> = branch.values.iter().map(|&value| plot.place(value)).collect();
        let half = places.len() / 2;
        let frame = |place| if place < half { first } else { last };
        let mirrored: Vec<_> =
            branch.values.iter().map(|&(re, im)| plot.place((re, -im))).collect();
        for (places, width, arrow) in [(&places, 2, 0.4), (&mirrored, 1, 0.6)] {
            let parts = Frame::clip(places, frame);
            let longest = parts.iter().max_by_key(|part| part.len());
            if let Some(part) = longest.filter(|_| judged) {
                // The mirror image has the opposite direction.
                let mut part = part.clone();
                if width == 1 {
                    part.reverse();
                }
                plot.arrow(&part, arrow)?;
            }
            for part in &parts {
                plot.line_in(*dash, part, line.ink().stroke_width(width * UNITS))?;
            }
        }
    }
    // Curves that are not judged may leave the frame.
    if curve.role == Role::Alone { Ok(Vec::new()) } else { infinity::draw(plot, curve, frames) }
}

/// Marks the minima, and returns them with their labels: in a row for several at one place; a single scene
/// has its label in the legend.
fn draw_minima(
    chart: &mut Plane<'_, '_>,
    scenes: &[NyquistScene],
    x: &Range<f64>,
    height: f64,
) -> Drawn<Vec<((f64, f64), String)>> {
    let width = x.end - x.start;
    let near = |a: (f64, f64), b: (f64, f64)| {
        (a.0 - b.0).abs() < 0.04 * width && (a.1 - b.1).abs() < 0.1 * height
    };
    let mut labels: Vec<((f64, f64), String)> = Vec::new();
    let marked = scenes.iter().enumerate().flat_map(|(index, scene)| {
        scene.curves.iter().filter(|curve| curve.role.is_judged()).map(move |curve| (index, curve))
    });
    for (index, curve) in marked {
        let Some(alpha) = curve.alpha else { continue };
        let at = curve.minimum.filter(|point| point.1.abs() <= height).unwrap_or((-alpha, 0.0));
        if !x.contains(&at.0) {
            continue;
        }
        chart.draw_series([
            Circle::new(at, units(5), WHITE.filled()),
            Circle::new(at, units(5), pen(2)),
        ])?;
        if scenes.len() == 1 {
            continue;
        }
        if let Some((_, numbers)) = labels.iter_mut().find(|(other, _)| near(*other, at)) {
            *numbers += &format!(", {}", index + 1);
        } else {
            labels.push((at, (index + 1).to_string()));
        }
    }
    Ok(labels)
}

#[cfg(test)]
mod tests;
