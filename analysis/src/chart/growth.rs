//! The growth of an oscillation that the certificate would have prevented.

use super::*;

/// Draws an angle over time that grows, with the time axis in s.
pub fn growth(title: &str, period: f64, position: &[f64]) -> Result<Picture, ChartError> {
    if position.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    let times = 0.0..period * position.len() as f64;
    let angles = padded(span(position.iter().copied()), 0.1);
    Page::new(title, &[HEIGHT]).draw(|areas| {
        let points = position.iter().enumerate();
        let points = points.map(|(sample, &value)| (sample as f64 * period, value));
        let (x, y) = (Axis::linear(times, "time (s)"), Axis::linear(angles, "angle (rad)"));
        Panel::new(&areas[0], x, y)?.curve(Stroke::solid(1), points)
    })
}
