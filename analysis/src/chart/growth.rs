//! How an oscillation grows that the certificate would have prevented.

use std::path::Path;

use plotters::prelude::*;

use super::*;

/// Draws an angle over time that grows, with the time axis in s.
///
/// # Errors
/// Where there are fewer than two samples, or the file cannot be written.
pub fn growth(path: &Path, title: &str, period: f64, position: &[f64]) -> Result<(), ChartError> {
    if position.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    draw(path, |area| {
        let y = padded(span(position.iter().copied()), 0.1);
        let mut chart = ChartBuilder::on(area)
            .caption(title, text(TITLE))
            .margin(MARGIN)
            .margin_right(MARGIN_RIGHT)
            .x_label_area_size(X_LABELS)
            .y_label_area_size(Y_LABELS)
            .build_cartesian_2d(0.0..period * position.len() as f64, y)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(UNITS))
            .axis_style(pen(1))
            .set_all_tick_mark_size(units(5))
            .x_desc("time (s)")
            .y_desc("angle (rad)")
            .x_label_formatter(&axis_number)
            .y_label_formatter(&axis_number)
            .label_style(text(LABEL))
            .draw()?;
        let points = position.iter().enumerate();
        let points = points.map(|(sample, &value)| (sample as f64 * period, value));
        chart.draw_series(LineSeries::new(points, pen(1)))?;
        Ok(())
    })
}
