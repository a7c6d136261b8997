//! The result of a measurement of a device: its responses in the disk of their passivity, and the fitted
//! damping and inertia (theory, section 3.3).

use std::f64::consts::TAU;

use nalgebra::Complex;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::*;
use crate::identify::{FrequencyPoint, Identification};
use crate::quantity::significant;

/// Width and height of the picture in pixels.
const SIZE: (u32, u32) = (1060, 580);

/// Width in pixels of the left part, with the same scale in both directions, so that the disk is round.
const LEFT: i32 = 590;

/// Points of a curve.
const POINTS: usize = 400;

/// Half-length of a bar in standard deviations: a 95 % interval.
const BAR: f64 = 1.96;

/// Over frequency in Hz.
type Spectrum<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, RangedCoordf64>>;

/// Draws the responses `J` of a device with the disk that they lie in, and over frequency their
/// inverses, with the device that was fitted to them.
///
/// # Errors
/// If there is only one response, or the drawing fails.
pub fn identify(title: &str, found: &Identification) -> Result<Picture, ChartError> {
    if found.responses.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    draw_sized(SIZE, |area| {
        let area = area.margin(MARGIN, 0, 0, 0).titled(title, text(TITLE))?;
        let (left, right) = area.split_horizontally(units(LEFT));
        let (upper, lower) = right.split_vertically(right.dim_in_pixel().1 as i32 / 2);
        nyquist(&left, found)?;
        damping(&upper, found)?;
        inertia(&lower, found)
    })
}

/// `1/J` of the fitted device with the delay of its torque.
fn fitted(found: &Identification, omega: f64) -> Complex<f64> {
    found.model.impedance(omega)
}

/// The sum of lag and delay, if significant.
fn late(found: &Identification) -> f64 {
    if found.mean_delay.is_significant() { found.mean_delay.value } else { 0.0 }
}

fn nyquist(area: &Area<'_>, found: &Identification) -> Drawn<()> {
    let dots: Vec<_> = found.responses.iter().map(|r| (r.admittance.re, r.admittance.im)).collect();
    let radius = disk(found).unwrap_or(0.0);
    let far = dots.iter().map(|p| p.0.abs().max(2.0 * p.1.abs())).fold(2.0 * radius, f64::max);
    let left = dots.iter().map(|p| p.0).fold(-0.06 * far, f64::min);
    let x = left..1.06 * far;
    // The same scale as across.
    let room = |labels: i32, other: i32| f64::from(labels + 2 * other);
    let (width, height) = area.dim_in_pixel();
    let part =
        (f64::from(height) - room(X_LABELS, MARGIN)) / (f64::from(width) - room(Y_LABELS, MARGIN));
    let half = 0.5 * part * (x.end - x.start);
    let mut chart = axes::chart(area).build_cartesian_2d(x.clone(), -half..half)?;
    let names = ("real part of J (rad/(N m s))", "imaginary part of J (rad/(N m s))");
    Axes::named(names.0, names.1).draw(&mut chart)?;
    let axes = [vec![(x.start, 0.0), (x.end, 0.0)], vec![(0.0, -half), (0.0, half)]];
    chart.draw_series(axes.map(|axis| PathElement::new(axis, pen(1))))?;
    let rim = |i: usize| {
        let angle = TAU * i as f64 / POINTS as f64;
        (radius * (1.0 + angle.cos()), radius * angle.sin())
    };
    chart.draw_series(broken((0..=POINTS).map(rim), 8, 5, 1))?;
    chart.draw_series(LineSeries::new(fitted_curve(found), pen(2)))?;
    chart.draw_series(dots.into_iter().map(|p| Circle::new(p, units(4), BLACK.filled())))?;
    name_curves(&mut chart, found, far)
}

/// `J` of the fitted device from rest to the fastest response, in even steps of its own angle.
fn fitted_curve(found: &Identification) -> impl Iterator<Item = (f64, f64)> {
    let (b, m) = (found.damping.value, found.inertia.value);
    let last = (fastest(found) * m).atan2(b);
    let point = move |i: usize| {
        let omega = (last * i as f64 / POINTS as f64).tan() * b / m;
        let admittance = 1.0 / fitted(found, omega);
        (admittance.re, admittance.im)
    };
    (0..=POINTS).map(point).filter(|point| point.0.is_finite() && point.1.is_finite())
}

/// Angular frequency in rad/s of the fastest response.
fn fastest(found: &Identification) -> f64 {
    found.responses.iter().map(|r| r.omega).fold(0.0, f64::max)
}

/// Frequencies in Hz of the responses.
fn measured(found: &Identification) -> Range<f64> {
    span(found.responses.iter().map(|r| r.omega / TAU))
}

/// Frequencies in Hz that the picture shows.
fn shown(found: &Identification) -> Range<f64> {
    let range = measured(found);
    range.start / 1.5..range.end * 1.5
}

/// Radius of the disk in rad/(N m s); `None` if no disk contains the responses.
fn disk(found: &Identification) -> Option<f64> {
    (found.disk.delta > 0.0).then(|| 0.5 / found.disk.delta)
}

/// In the upper half of the disk, which is empty: torque and motion are sines, and their responses
/// are below the axis.
fn name_curves(chart: &mut Plane<'_, '_>, found: &Identification, far: f64) -> Drawn<()> {
    let hertz = significant(found.disk.omega / TAU, 4);
    let mut rows = vec!["dots: responses measured".to_owned(), format!("solid: {}", model(found))];
    match disk(found) {
        Some(radius) => rows.extend([
            format!("dashed: disk, delta = {}", significant(found.disk.delta, 4)),
            format!("radius 1/(2 delta) = {}", significant(radius, 4)),
            format!("touched at {hertz} Hz"),
        ]),
        None => rows.extend(["no disk holds the responses:".to_owned(), format!("see {hertz} Hz")]),
    }
    for (row, name) in rows.into_iter().enumerate() {
        let place = (0.5 * far, (0.37 - 0.065 * row as f64) * far);
        chart.draw_series([Text::new(name, place, anchored(HPos::Center, VPos::Center))])?;
    }
    Ok(())
}

/// The text on the fitted device.
fn model(found: &Identification) -> String {
    match late(found) {
        0.0 => "1/(b + j w m) fitted".to_owned(),
        late => format!("fitted, {} us late", significant(1e6 * late, 3)),
    }
}

/// The real parts of `1/J` over frequency: the damping, except for lag and delay.
fn damping(area: &Area<'_>, found: &Identification) -> Drawn<()> {
    let estimate = &found.damping;
    let real = |r: &FrequencyPoint| r.impedance().re;
    let mut chart = spectrum(area, found, real, (None, "Re 1/J (N m s/rad)"))?;
    let shown = shown(found);
    let band = [(shown.start, estimate.lo), (shown.end, estimate.hi)];
    chart.draw_series([Rectangle::new(band, FORBIDDEN.filled())])?;
    let level = vec![(shown.start, estimate.value), (shown.end, estimate.value)];
    chart.draw_series([PathElement::new(level, pen(1))])?;
    let late = late(found) != 0.0;
    if late {
        chart.draw_series(broken(over(found, |omega| fitted(found, omega).re), 8, 5, 1))?;
    }
    bars(&mut chart, found, real)?;
    let reach = significant(0.5 * (estimate.hi - estimate.lo), 2);
    let late = if late { "; dashed: with lag and delay" } else { "" };
    let value = significant(estimate.value, 5);
    caption(area, format!("b = {value} +- {reach} N m s/rad{late}"))
}

/// The imaginary parts of `1/J` over frequency: inertia times angular frequency.
fn inertia(area: &Area<'_>, found: &Identification) -> Drawn<()> {
    let estimate = &found.inertia;
    let imaginary = |r: &FrequencyPoint| r.impedance().im;
    let names = (Some("frequency (Hz)"), "Im 1/J (N m s/rad)");
    let mut chart = spectrum(area, found, imaginary, names)?;
    chart.draw_series(LineSeries::new(over(found, |omega| fitted(found, omega).im), pen(1)))?;
    bars(&mut chart, found, imaginary)?;
    let reach = significant(0.5 * (estimate.hi - estimate.lo), 2);
    caption(area, format!("m = {} +- {reach} kg m^2", significant(estimate.value, 5)))
}

/// A curve from the slowest response to the fastest.
fn over(found: &Identification, value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let range = measured(found);
    let ratio = range.end / range.start;
    let hertz = |i: usize| range.start * ratio.powf(i as f64 / POINTS as f64);
    (0..=POINTS).map(|i| (hertz(i), value(TAU * hertz(i)))).collect()
}

/// Axes over frequency for parts of `1/J`, with room for their bars and for a caption above.
fn spectrum<'a, 'b>(
    area: &'a Area<'b>,
    found: &Identification,
    part: impl Fn(&FrequencyPoint) -> f64,
    (x, y): (Option<&str>, &str),
) -> Drawn<Spectrum<'a, 'b>> {
    let ends = |r: &FrequencyPoint| [-BAR, BAR].map(|reach| part(r) + reach * r.deviation);
    let range = padded(span(found.responses.iter().flat_map(ends)), 0.1);
    let mut chart = axes::chart(area)
        .margin_top(2 * MARGIN)
        .margin_right(MARGIN_RIGHT)
        .build_cartesian_2d(shown(found).log_scale(), range.clone())?;
    Axes { most: (11, 6), ..Axes::named(x, y) }.draw(&mut chart)?;
    Ok(chart)
}

/// The responses with their 95 % intervals.
fn bars(
    chart: &mut Spectrum<'_, '_>,
    found: &Identification,
    part: impl Fn(&FrequencyPoint) -> f64,
) -> Drawn<()> {
    for response in &found.responses {
        let (hertz, value) = (response.omega / TAU, part(response));
        let reach = BAR * response.deviation;
        let bar = vec![(hertz, value - reach), (hertz, value + reach)];
        chart.draw_series([PathElement::new(bar, pen(1))])?;
        chart.draw_series([Circle::new((hertz, value), units(3), BLACK.filled())])?;
    }
    Ok(())
}

/// Text above a part of the chart, where no curve is in the way.
fn caption(area: &Area<'_>, words: String) -> Drawn<()> {
    let middle = (area.dim_in_pixel().0 as i32 + Y_LABELS) / 2;
    area.draw(&Text::new(words, (middle, MARGIN), anchored(HPos::Center, VPos::Center)))
}
