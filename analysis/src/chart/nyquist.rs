//! The paper's Nyquist plots: `(T z / (z - 1)) E(z)` and the line that it must not cross.

use std::f64::consts::PI;
use std::path::Path;

use firmware::certificate::{Loop, assess};
use firmware::scene::Scene;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::*;
use crate::minimum::least;
use crate::quantity::significant;
use crate::response::Response;

/// Points on half the unit circle. They are denser towards rest, where an integrator's curve is
/// longest.
const POINTS: usize = 800;

/// What there is to draw.
struct Picture {
    title: String,
    /// Real and imaginary part for angles from nearly 0 to pi.
    curve: Vec<(f64, f64)>,
    /// Whether the curve runs off to infinity at rest.
    has_integrator: bool,
    /// Where the real part is least; `None` where it is the same all around.
    minimum: Option<(f64, f64)>,
    /// Passivity of the device, the critical line being at minus that.
    delta: f64,
    alpha: Option<f64>,
}

/// Draws the Nyquist plot of a scene's environment for velocity, `(T z / (z - 1)) E(z)`, with the
/// critical line at `-delta` and the curve's minimum marked.
///
/// # Errors
/// Where the environment has no transfer function, or the file cannot be written.
pub fn nyquist(path: &Path, title: &str, scene: &Scene) -> Result<(), ChartError> {
    let transfers = Loop::of(scene).map_err(ChartError::NoTransfer)?;
    let velocity = Response::new(transfers.environment).from_velocity(scene.timing.period);
    let assessment = assess(scene);
    let point = |theta: f64| {
        let value = velocity.at_angle(theta);
        (value.re, value.im)
    };
    let curve: Vec<_> = (0..=POINTS)
        .map(|index| PI * (1e-3_f64).powf(1.0 - index as f64 / POINTS as f64))
        .map(point)
        .collect();
    let minimum = least(|theta| velocity.at_angle(theta).re, 0.0, PI);
    let picture = Picture {
        title: title.to_owned(),
        has_integrator: curve.first().is_some_and(|start| start.1.abs() > 10.0 * start.0.abs()),
        minimum: minimum.map(|theta| point(theta.max(1e-3))),
        curve,
        delta: assessment.delta.midpoint(),
        alpha: assessment.alpha.map(|alpha| alpha.midpoint()),
    };
    draw(path, |area| paint(area, &picture))
}

fn paint(area: &Area<'_>, picture: &Picture) -> Drawn<()> {
    let line = -picture.delta;
    let right = span(picture.curve.iter().map(|point| point.0).chain([line, 0.0]));
    // Room on the left for the name of the critical line.
    let width = right.end - right.start;
    let x = right.start - 0.3 * width..right.end + 0.1 * width;
    let height = if picture.has_integrator {
        // The curve has no end; as much of it as is wide is enough to see where it goes.
        1.2 * (x.end - x.start)
    } else {
        1.3 * span(picture.curve.iter().map(|point| point.1.abs())).end
    };
    let y = -height..height;
    let mut chart = ChartBuilder::on(area)
        .caption(&picture.title, text(TITLE))
        .margin(MARGIN)
        .x_label_area_size(X_LABELS)
        .y_label_area_size(Y_LABELS)
        .build_cartesian_2d(x.clone(), y.clone())?;
    let forbidden = Rectangle::new([(x.start, y.start), (line, y.end)], FORBIDDEN.filled());
    chart.draw_series([forbidden])?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(UNITS))
        .axis_style(pen(1))
        .set_all_tick_mark_size(units(5))
        .x_desc("real part (N m s/rad)")
        .y_desc("imaginary part (N m s/rad)")
        .x_label_formatter(&axis_number)
        .y_label_formatter(&axis_number)
        .label_style(text(LABEL))
        .draw()?;
    let axes = [vec![(x.start, 0.0), (x.end, 0.0)], vec![(0.0, y.start), (0.0, y.end)]];
    chart.draw_series(axes.map(|axis| PathElement::new(axis, pen(1))))?;
    let critical = [(line, y.start), (line, y.end)];
    chart.draw_series(broken(critical, 8, 5, 2))?;
    let seen: Vec<_> =
        picture.curve.iter().copied().filter(|point| point.1.abs() <= height).collect();
    let mirrored: Vec<_> = seen.iter().map(|&(re, im)| (re, -im)).collect();
    chart.draw_series(LineSeries::new(seen, pen(2)))?;
    // Angles from -pi to 0, as the conjugate.
    chart.draw_series(broken(mirrored, 3, 3, 2))?;
    let left_of_line = line - 0.012 * (x.end - x.start);
    let rows = ["critical line".to_owned(), format!("-delta = {}", significant(line, 4))];
    for (row, name) in rows.into_iter().enumerate() {
        let place = (left_of_line, y.end * (0.95 - 0.075 * row as f64));
        chart.draw_series([Text::new(name, place, anchored(HPos::Right, VPos::Center))])?;
    }
    label_minimum(&mut chart, picture, &x, height)
}

type Plane<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn label_minimum(
    chart: &mut Plane<'_, '_>,
    picture: &Picture,
    x: &Range<f64>,
    height: f64,
) -> Drawn<()> {
    let Some(alpha) = picture.alpha else { return Ok(()) };
    let at = picture.minimum.filter(|point| point.1.abs() <= height);
    let (re, im) = at.unwrap_or((-alpha, 0.0));
    chart.draw_series([
        Circle::new((re, im), units(5), WHITE.filled()),
        Circle::new((re, im), units(5), pen(2)),
    ])?;
    let words = if picture.minimum.is_some() { "least real part" } else { "real part everywhere" };
    let name = format!("{words}, -alpha = {}", significant(-alpha, 4));
    // Above the axis, where the mirrored half of the curve leaves the point to the right.
    let place = (re + 0.02 * (x.end - x.start), im + 0.06 * height);
    chart.draw_series([Text::new(name, place, anchored(HPos::Left, VPos::Bottom))])?;
    Ok(())
}
