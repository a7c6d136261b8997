//! The stiffest certified wall over the sample rate, and below it the encoder's ripple.

use super::*;
use crate::limits::Point;
use crate::quantity::significant;

/// Heights of the panels in pixels.
const PANELS: [i32; 2] = [320, 280];
/// Room above and below the curves, as a factor.
const ROOM: f64 = 1.6;
/// The line at the scene's own rate.
const OWN: Stroke = Stroke::dashed(&[3, 3], 1);

#[derive(Clone, Debug, PartialEq)]
pub struct DelayCurve {
    pub delay: usize,
    /// Whether any stiffness is certified; the coupling is then drawn instead.
    pub is_coupling: bool,
    /// From the lowest to the highest rate.
    pub points: Vec<Point>,
}

/// The scene itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Own {
    /// Its sample rate in Hz.
    pub rate: f64,
    /// Stiffness of its wall in N m/rad.
    pub stiffness: f64,
    /// Delay of its wall in samples.
    pub delay: usize,
}

/// Draws largest stiffness and torque ripple for several delays. `wanted` is the range of stiffness. A cross
/// marks the scene's own wall, and a vertical line its rate. `note` states the conditions of the ripple.
pub fn limits(
    title: &str,
    note: &str,
    curves: &[DelayCurve],
    own: &Own,
    wanted: Option<Range<f64>>,
) -> Result<Picture, ChartError> {
    let all = || curves.iter().flat_map(|curve| &curve.points);
    let rates = span(all().map(|point| point.rate));
    let stiffness = span(all().map(|point| point.stiffness));
    let ripple = span(all().filter_map(|point| point.ripple));
    if rates.start >= rates.end || stiffness.start <= 0.0 || ripple.start <= 0.0 {
        return Err(ChartError::TooFewPoints);
    }
    meets("vertical", wanted.as_ref(), &stiffness)?;
    let roomy = |range: Range<f64>| range.start / ROOM..range.end * ROOM;
    let rate = |name| Axis::logarithmic(rates.clone(), name);
    let stiffness = wanted.unwrap_or_else(|| roomy(stiffness));
    let stiffness = Axis::logarithmic(stiffness, "largest stiffness (N m/rad)");
    let ripple = Axis::logarithmic(roomy(ripple), "torque ripple (N m)");
    let is_seen = rate("").holds(own.rate) && stiffness.holds(own.stiffness);
    Page::new(title, &PANELS).legend(1, legend(note, curves, own, is_seen)).draw(|areas| {
        let upper = Panel::new(&areas[0], rate(""), stiffness)?;
        let lower = Panel::new(&areas[1], rate("sample rate (Hz)"), ripple)?;
        for (index, curve) in curves.iter().enumerate() {
            let (stroke, points) = (Stroke::of(index, 2), &curve.points);
            upper.curve(stroke, points.iter().map(|p| (p.rate, p.stiffness)))?;
            lower.curve(stroke, points.iter().filter_map(|p| Some((p.rate, p.ripple?))))?;
        }
        upper.upright(OWN, own.rate)?;
        lower.upright(OWN, own.rate)?;
        upper.mark(Mark::SCENE, (own.rate, own.stiffness))
    })
}

fn legend(
    note: &str,
    curves: &[DelayCurve],
    Own { rate, stiffness, delay }: &Own,
    is_seen: bool,
) -> Vec<(Sample, String)> {
    let words = |curve: &DelayCurve| {
        let end = curve.points.last().map_or_else(
            || "nothing is certified".to_owned(),
            |last| {
                let (k, rate) = (significant(last.stiffness, 3), significant(last.rate, 3));
                format!("{k} N m/rad at {rate} Hz")
            },
        );
        let what = if curve.is_coupling { " (any wall: the coupling limits)" } else { "" };
        format!("delay {}{what}: {end}", curve.delay)
    };
    let curves = curves.iter().enumerate();
    let curves = curves.map(|(row, curve)| (Sample::Line(Stroke::of(row, 2)), words(curve)));
    let (k, rate) = (significant(*stiffness, 4), significant(*rate, 5));
    let scene = format!("the scene, {k} N m/rad at {rate} Hz, delay {delay}");
    let scene = Sample::Point(Mark::SCENE).entry(is_seen, scene);
    curves.chain([scene, (Sample::Nothing, note.to_owned())]).collect()
}
