//! The paper's Nyquist plots: the judged transfer function of a scene, and the line that it must not cross.

mod legend;
mod marks;

use haptic_servo::scene::Scene;

use super::*;
use crate::nyquist::{Curve, NyquistScene, Role, critical_lines, usual_window};

/// The lines of the axes, of an asymptote, of the line that is not to be crossed, and of a bound that is
/// judged in place of a curve.
const AXIS: Stroke = Stroke::solid(1);
const ASYMPTOTE: Stroke = Stroke::dashed(&[1, 7], 1);
const CRITICAL: Stroke = Stroke::dashed(&[8, 5], 2);
const BOUND: Stroke = Stroke::solid(3);

/// A curve and its line.
type Line<'j> = (Stroke, &'j Curve);

/// The lines of each scene, grey for curves that are not judged. Each curve takes a pattern, except an
/// environment alone, which takes the first pattern of its scene.
fn lines(scenes: &[NyquistScene]) -> Vec<Vec<Line<'_>>> {
    let mut lines = Vec::new();
    let mut unused = 0;
    for scene in scenes {
        let first = unused;
        let mut of_scene = Vec::new();
        for curve in &scene.curves {
            let is_alone = curve.role == Role::Alone;
            let stroke = Stroke::of(if is_alone { first } else { unused }, 2);
            unused += usize::from(!is_alone);
            of_scene.push((if curve.role.is_judged() { stroke } else { stroke.faint() }, curve));
        }
        lines.push(of_scene);
    }
    lines
}

/// Draws the Nyquist plots of named scenes for velocity, `(T z / (z - 1)) G`: the judged curve in black, with
/// its critical line, its least real part and frequencies marked; and, in grey, the environment alone if it
/// differs. If a pole on the unit circle takes a curve to infinity, the legend has the side of its closure.
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
    let page = Page::new(title, &[HEIGHT]).legend(1, legend::entries(&scenes));
    page.draw(|areas| paint(&areas[0], &scenes, wanted))
}

fn judged(scenes: &[(String, Scene)]) -> Result<Vec<NyquistScene>, ChartError> {
    scenes.iter().map(|(name, scene)| Ok(NyquistScene::of(name, scene)?)).collect()
}

/// The curves as numbers, at rising angles from 0 to the Nyquist frequency.
pub fn data(scenes: &[(String, Scene)]) -> Result<Data, ChartError> {
    let rows = judged(scenes)?.into_iter().flat_map(|scene| {
        let NyquistScene { name, period, curves, limit, bound, .. } = scene;
        curves.into_iter().flat_map(move |curve| {
            let words = [&*name, curve.role.as_str()].map(Cell::from);
            let points: Vec<_> = curve.points().collect();
            points.into_iter().map(move |(theta, (re, im))| {
                let frequency = theta / (2.0 * std::f64::consts::PI * period);
                let numbers = [theta, frequency, re, im].map(Cell::from);
                let lines = [limit, bound].map(|line| line.map(|line| -line).into());
                words.iter().cloned().chain(numbers).chain(lines).collect()
            })
        })
    });
    let header = "scene,curve,angle (rad),frequency (Hz),real part (N m s/rad),\
                  imaginary part (N m s/rad),critical line (N m s/rad),bound (N m s/rad)";
    Ok(Data::new(header, rows))
}

fn paint(area: &Area<'_>, scenes: &[NyquistScene], wanted: &Window) -> Drawn<()> {
    let (x, y) = usual_window(scenes, wanted.x.clone(), wanted.y.clone());
    let (real, imaginary) = (
        Axis::linear(x.clone(), "real part (N m s/rad)"),
        Axis::linear(y.clone(), "imaginary part (N m s/rad)"),
    );
    let mut panel = Panel::bare(area, "", real, imaginary)?;
    let criticals = critical_lines(scenes);
    // The region left of all lines is forbidden for every scene; without any line, the whole plane.
    let end = criticals.first().map_or(x.end, |line| line.0);
    panel.fill(FORBIDDEN, [(x.start, y.start), (end, y.start), (end, y.end), (x.start, y.end)])?;
    panel.grid()?;
    panel.level(AXIS, 0.0)?;
    panel.upright(AXIS, 0.0)?;
    criticals.iter().try_for_each(|line| panel.upright(CRITICAL, line.0))?;
    lines(scenes).iter().flatten().try_for_each(|line| draw_curve(&panel, line))?;
    // All motion of a scene is on the right of its bound.
    let mut bounds = scenes.iter().filter_map(|scene| Some(-scene.bound?));
    bounds.try_for_each(|bound| panel.upright(BOUND, bound))?;
    let minima = draw_minima(&panel, scenes, (x.end - x.start, y.end))?;
    marks::draw(&panel, scenes, &minima)
}

/// The curve, and in a thinner line its mirror image for negative angles, with arrows in the direction of
/// rising angles; and its asymptote at rest, if it goes to infinity, as a hairline.
fn draw_curve(panel: &Panel<'_, '_>, (stroke, curve): &Line<'_>) -> Drawn<()> {
    let judged = curve.role.is_judged();
    if let Some(re) = curve.asymptote.filter(|_| judged) {
        panel.upright(ASYMPTOTE, re)?;
    }
    for branch in &curve.branches {
        let places: Vec<_> = branch.values.iter().map(|&value| panel.place(value)).collect();
        let mirrored: Vec<_> = places.iter().map(|&place| panel.mirrored(place)).collect();
        for (places, width, arrow) in [(&places, 2, 0.4), (&mirrored, 1, 0.6)] {
            let parts = panel.frame.clip(places);
            let longest = parts.iter().max_by_key(|part| part.len());
            if let Some(part) = longest.filter(|_| judged) {
                // The mirror image has the opposite direction.
                let mut part = part.clone();
                if width == 1 {
                    part.reverse();
                }
                panel.arrow(&part, arrow)?;
            }
            parts.iter().try_for_each(|part| panel.line(stroke.wide(width), part))?;
        }
    }
    Ok(())
}

/// Marks the minima, and returns them with their labels: in a row for several at one place; a single scene
/// has its label in the legend. `size` is the width of the panel and its height above the real axis.
fn draw_minima(
    panel: &Panel<'_, '_>,
    scenes: &[NyquistScene],
    (width, height): (f64, f64),
) -> Drawn<Vec<((f64, f64), String)>> {
    let near = |a: (f64, f64), b: (f64, f64)| {
        (a.0 - b.0).abs() < 0.04 * width && (a.1 - b.1).abs() < 0.1 * height
    };
    let mut labels: Vec<((f64, f64), String)> = Vec::new();
    let numbered = (1_usize..)
        .zip(scenes)
        .flat_map(|(number, scene)| scene.judged_curves().map(move |curve| (number, curve)));
    for (number, curve) in numbered {
        let Some(alpha) = curve.alpha else { continue };
        let at = curve.minimum.filter(|&point| panel.holds(point)).unwrap_or((-alpha, 0.0));
        panel.mark(Mark::RING, at)?;
        if scenes.len() == 1 || !panel.holds(at) {
            continue;
        }
        if let Some((_, numbers)) = labels.iter_mut().find(|(other, _)| near(*other, at)) {
            *numbers += &format!(", {number}");
        } else {
            labels.push((at, number.to_string()));
        }
    }
    Ok(labels)
}
