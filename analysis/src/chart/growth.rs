//! How an oscillation grows that the certificate would have prevented.

use plotters::prelude::*;

use super::*;

/// Draws an angle over time that grows, with the time axis in s.
///
/// # Errors
/// Where there are fewer than two samples.
pub fn growth(title: &str, period: f64, position: &[f64]) -> Result<Picture, ChartError> {
    if position.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    draw(|area| {
        let y = padded(span(position.iter().copied()), 0.1);
        let mut chart = ChartBuilder::on(area)
            .caption(title, text(TITLE))
            .margin(MARGIN)
            .margin_right(MARGIN_RIGHT)
            .x_label_area_size(X_LABELS)
            .y_label_area_size(Y_LABELS)
            .build_cartesian_2d(0.0..period * position.len() as f64, y)?;
        mesh(&mut chart, Some("time (s)"), "angle (rad)")?;
        let points = position.iter().enumerate();
        let points = points.map(|(sample, &value)| (sample as f64 * period, value));
        chart.draw_series(LineSeries::new(points, pen(1)))?;
        Ok(())
    })
}
