//! Stiffness at the handle over the rate: of the stiffest certified wall, and of the stiffest that is silent at
//! rest.

use super::*;

/// Room above and below the curves, as a factor.
const ROOM: f64 = 1.3;
/// The line at the device's own rate.
const OWN: Stroke = Stroke::dashed(&[3, 3], 1);

/// Draws curves of rate in Hz and stiffness in N m/rad, each with its name; a vertical line is at `own` Hz.
pub fn device(
    title: &str,
    own: f64,
    curves: &[(&str, Vec<(f64, f64)>)],
) -> Result<Picture, ChartError> {
    let all = || curves.iter().flat_map(|(_, curve)| curve);
    let [rates, felt] = [span(all().map(|point| point.0)), span(all().map(|point| point.1))];
    if rates.start >= rates.end || felt.start <= 0.0 {
        return Err(ChartError::TooFewPoints);
    }
    let axes = Axes::new(
        (Axis::logarithmic(rates.start / ROOM..rates.end * ROOM), "rate (Hz)"),
        (Axis::logarithmic(felt.start / ROOM..felt.end * ROOM), "felt stiffness (N m/rad)"),
    );
    let names = curves.iter().enumerate();
    let names =
        names.map(|(row, (name, _))| (Sample::Line(Stroke::of(row, 2)), (*name).to_owned()));
    let legends = vec![Legend::new(2, names)];
    Page { title, width: WIDTH, heights: &[HEIGHT], legends }.draw(|areas| {
        let panel = Panel::new(&areas[0], axes)?;
        for (row, (_, curve)) in curves.iter().enumerate() {
            panel.curve(Stroke::of(row, 2), curve.iter().copied())?;
        }
        panel.upright(OWN, own)
    })
}
