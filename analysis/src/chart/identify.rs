//! The result of a measurement of a device: its responses in the disk of their passivity, and the fitted
//! damping and inertia (theory, section 3.3).

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::*;
use crate::identify::{Estimate, FrequencyPoint, Identification};
use crate::quantity::significant;

/// Width and height of the panels in pixels.
const SIZE: (i32, i32) = (1060, 530);
/// Width in pixels of the left part, with the same scale in both directions, so that the disk is round.
const LEFT: i32 = 590;
const POINTS: usize = 400;
/// Half-length of a bar in standard deviations: a 95 % interval.
const BAR: f64 = 1.96;
/// The lines of the axes, the fitted device, its fitted value, the disk, and the value with lag and delay.
const AXIS: Stroke = Stroke::solid(1);
const FITTED: Stroke = Stroke::solid(2);
const VALUE: Stroke = Stroke::solid(1);
const DISK: Stroke = Stroke::dashed(&[8, 5], 1);
const LATE: Stroke = Stroke::dashed(&[2, 4], 1);

/// Draws the responses `J` of a device with the disk that they lie in, and over frequency their
/// inverses, with the device that was fitted to them.
pub fn identify(title: &str, found: &Identification) -> Result<Picture, ChartError> {
    if found.responses.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    Page::new(title, &[SIZE.1]).wide(SIZE.0).legend(2, legend(found)).draw(|areas| {
        let (left, right) = areas[0].split_horizontally(units(LEFT));
        let (upper, lower) = right.split_vertically(units(SIZE.1 / 2));
        admittance(&left, found)?;
        damping(&upper, found)?;
        inertia(&lower, found)
    })
}

fn legend(found: &Identification) -> Vec<(Sample, String)> {
    let number = |value: f64| significant(value, 4);
    let hertz = number(found.disk.omega / TAU);
    let disk = match disk(found) {
        Some(radius) => format!(
            "disk, delta = {}: radius 1/(2 delta) = {}, touched at {hertz} Hz",
            number(found.disk.delta),
            number(radius)
        ),
        None => format!("no disk holds the responses: see {hertz} Hz"),
    };
    let model = match late(found) {
        0.0 => "1/(b + j w m) fitted".to_owned(),
        late => format!("fitted, {} us late", significant(1e6 * late, 3)),
    };
    let mut entries = vec![
        (Sample::Point(Mark::DOT), "responses measured, with their 95 % intervals".to_owned()),
        (Sample::Line(FITTED), model),
        (Sample::Line(DISK), disk),
        (Sample::Region(Fill::Solid(FORBIDDEN)), "95 % interval of the fitted value".to_owned()),
    ];
    if late(found) != 0.0 {
        entries.push((Sample::Line(LATE), "fitted, with lag and delay".to_owned()));
    }
    entries
}

/// The sum of lag and delay, if significant.
fn late(found: &Identification) -> f64 {
    if found.mean_delay.is_significant() { found.mean_delay.value } else { 0.0 }
}

fn admittance(area: &Area<'_>, found: &Identification) -> Drawn<()> {
    let dots: Vec<_> = found.responses.iter().map(|r| (r.admittance.re, r.admittance.im)).collect();
    let radius = disk(found).unwrap_or(0.0);
    let far = dots.iter().map(|p| p.0.abs().max(2.0 * p.1.abs())).fold(2.0 * radius, f64::max);
    let left = dots.iter().map(|p| p.0).fold(-0.06 * far, f64::min);
    let x = left..1.06 * far;
    let real = Axis::linear(x.clone(), "real part of J (rad/(N m s))");
    let imaginary = |half: f64| Axis::linear(-half..half, "imaginary part of J (rad/(N m s))");
    // The same scale as across.
    let room = Panel::bare(area, "", real.clone(), imaginary(far))?.frame;
    let half = 0.5 * room.bottom / room.right * (x.end - x.start);
    let panel = Panel::new(area, real, imaginary(half))?;
    panel.level(AXIS, 0.0)?;
    panel.upright(AXIS, 0.0)?;
    let rim = |i: usize| {
        let angle = TAU * i as f64 / POINTS as f64;
        (radius * (1.0 + angle.cos()), radius * angle.sin())
    };
    panel.curve(DISK, (0..=POINTS).map(rim))?;
    panel.curve(FITTED, fitted_curve(found))?;
    dots.into_iter().try_for_each(|dot| panel.mark(Mark::DOT, dot))
}

/// `J` of the fitted device from rest to the fastest response, in even steps of its own angle.
fn fitted_curve(found: &Identification) -> impl Iterator<Item = (f64, f64)> {
    let (b, m) = (found.damping.value, found.inertia.value);
    let fastest = found.responses.iter().map(|r| r.omega).fold(0.0, f64::max);
    let last = (fastest * m).atan2(b);
    let point = move |i: usize| {
        let omega = (last * i as f64 / POINTS as f64).tan() * b / m;
        let admittance = 1.0 / found.model.impedance(omega);
        (admittance.re, admittance.im)
    };
    (0..=POINTS).map(point)
}

/// Radius of the disk in rad/(N m s); `None` if no disk contains the responses.
fn disk(found: &Identification) -> Option<f64> {
    (found.disk.delta > 0.0).then(|| 0.5 / found.disk.delta)
}

/// The real parts of `1/J` over frequency: the damping, except for lag and delay.
fn damping(area: &Area<'_>, found: &Identification) -> Drawn<()> {
    let estimate = &found.damping;
    let heading = format!("b = {} N m s/rad", with_reach(estimate));
    let names = ["", "Re 1/J (N m s/rad)"];
    spectrum(
        area,
        found,
        |value| value.re,
        &heading,
        names,
        |panel, [from, to]| {
            let [lo, hi] = [estimate.lo, estimate.hi];
            panel.fill(FORBIDDEN, [(from, lo), (to, lo), (to, hi), (from, hi)])?;
            panel.level(VALUE, estimate.value)?;
            match late(found) {
                0.0 => Ok(()),
                _ => panel.curve(LATE, over(found, |value| value.re)),
            }
        },
    )
}

/// The imaginary parts of `1/J` over frequency: inertia times angular frequency.
fn inertia(area: &Area<'_>, found: &Identification) -> Drawn<()> {
    let heading = format!("m = {} kg m^2", with_reach(&found.inertia));
    let names = ["frequency (Hz)", "Im 1/J (N m s/rad)"];
    spectrum(
        area,
        found,
        |value| value.im,
        &heading,
        names,
        |panel, _| panel.curve(VALUE, over(found, |value| value.im)),
    )
}

fn with_reach(Estimate { value, lo, hi }: &Estimate) -> String {
    format!("{} +- {}", significant(*value, 5), significant(0.5 * (hi - lo), 2))
}

/// A part of the fitted `1/J`, from the slowest response to the fastest.
fn over(found: &Identification, part: Part) -> Vec<(f64, f64)> {
    let range = measured(found);
    let ratio = range.end / range.start;
    let hertz = |i: usize| range.start * ratio.powf(i as f64 / POINTS as f64);
    let value = |hertz: f64| part(found.model.impedance(TAU * hertz));
    (0..=POINTS).map(|i| (hertz(i), value(hertz(i)))).collect()
}

/// The real or the imaginary part.
type Part = fn(Complex<f64>) -> f64;

/// Frequencies in Hz of the responses.
fn measured(found: &Identification) -> Range<f64> {
    span(found.responses.iter().map(|r| r.omega / TAU))
}

/// A panel over frequency: a part of `1/J` of the responses with its 95 % interval, over what `fitted` draws
/// between the lowest and the highest frequency.
fn spectrum(
    area: &Area<'_>,
    found: &Identification,
    part: Part,
    heading: &str,
    [x_name, y_name]: [&'static str; 2],
    fitted: impl FnOnce(&Panel<'_, '_>, [f64; 2]) -> Drawn<()>,
) -> Drawn<()> {
    let measured = measured(found);
    let shown = [measured.start / 1.5, measured.end * 1.5];
    let part = |r: &FrequencyPoint| part(r.impedance());
    let ends = |r: &FrequencyPoint| [-BAR, BAR].map(|reach| part(r) + reach * r.deviation);
    let range = padded(span(found.responses.iter().flat_map(ends)), 0.1);
    let x = Axis::logarithmic(shown[0]..shown[1], x_name);
    let panel = Panel::headed(area, heading, x, Axis::linear(range, y_name))?;
    fitted(&panel, shown)?;
    for response in &found.responses {
        let hertz = response.omega / TAU;
        panel.curve(VALUE, ends(response).map(|value| (hertz, value)))?;
        panel.mark(Mark::DOT, (hertz, part(response)))?;
    }
    Ok(())
}
