//! The growth of an oscillation that the certificate would have prevented.

use plotters::prelude::*;

use super::axes::Axes;
use super::*;

/// Draws an angle over time that grows, with the time axis in s.
///
/// # Errors
/// If there are fewer than two samples.
pub fn growth(title: &str, period: f64, position: &[f64]) -> Result<Picture, ChartError> {
    if position.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    draw(|area| {
        let y = padded(span(position.iter().copied()), 0.1);
        let mut chart = axes::chart(area)
            .caption(title, text(TITLE))
            .margin_right(MARGIN_RIGHT)
            .build_cartesian_2d(0.0..period * position.len() as f64, y)?;
        Axes::named("time (s)", "angle (rad)").draw(&mut chart)?;
        let points = position.iter().enumerate();
        let points = points.map(|(sample, &value)| (sample as f64 * period, value));
        chart.draw_series(LineSeries::new(points, pen(1)))?;
        Ok(())
    })
}
