//! Stiffness at the handle over the rate, of the stiffest certified walls: a curve for each structure, or for
//! each condition on the wall.

use super::*;
use crate::quantity::significant;

/// Room above and below the curves, as a factor.
const ROOM: f64 = 1.3;
/// The line at the device's own rate.
const OWN: Stroke = Stroke::dashed(&[3, 3], 1);

/// Draws curves of rate in Hz and stiffness in N m/rad, each with its name; a cross marks the wall that was
/// found, and a vertical line is at `own` Hz.
pub fn stiffest(
    title: &str,
    curves: &[(&str, Vec<(f64, f64)>)],
    found: Option<(f64, f64)>,
    own: Option<f64>,
) -> Result<Picture, ChartError> {
    let all = || curves.iter().flat_map(|(_, curve)| curve);
    let rates = span(all().map(|point| point.0));
    let felt = span(all().chain(&found).map(|point| point.1));
    if rates.start >= rates.end || felt.start <= 0.0 {
        return Err(ChartError::TooFewPoints);
    }
    let roomy =
        |range: Range<f64>, name| Axis::logarithmic(range.start / ROOM..range.end * ROOM, name);
    let line = |row| Sample::Line(Stroke::of(row, 2));
    let names = curves.iter().enumerate().map(|(row, (name, _))| (line(row), (*name).to_owned()));
    let best = found.map(|(rate, stiffness)| {
        let [rate, stiffness] = [rate, stiffness].map(|value| significant(value, 3));
        (Sample::Point(Mark::SCENE), format!("found: {stiffness} N m/rad at {rate} Hz"))
    });
    Page::new(title, &[HEIGHT]).legend(2, names.chain(best)).draw(|areas| {
        let (x, y) = (roomy(rates, "rate (Hz)"), roomy(felt, "felt stiffness (N m/rad)"));
        let panel = Panel::new(&areas[0], x, y)?;
        for (row, (_, curve)) in curves.iter().enumerate() {
            panel.curve(Stroke::of(row, 2), curve.iter().copied())?;
        }
        found.map_or(Ok(()), |found| panel.mark(Mark::SCENE, found))?;
        own.map_or(Ok(()), |own| panel.upright(OWN, own))
    })
}
