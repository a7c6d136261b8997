//! The stiffest certified wall over the sample rate, with the encoder's ripple on a second axis.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::{Axes, Scale};
use super::dash::Dash;
use super::*;
use crate::limits::Point;
use crate::quantity::significant;

/// Height of a line of the legend in pixels.
const ROW: i32 = 20;
/// Room for the numbers and the name of the axis on the right, in pixels.
const RIGHT_LABELS: i32 = units(84);
/// Room above, below and between the two groups of curves, as a factor.
const APART: f64 = 1.6;

/// A curve for one delay.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayCurve {
    /// Delay in samples.
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

/// Draws largest stiffness (thick, left axis) and torque ripple (thin, right axis) for several delays. The
/// axes are shifted so that the two groups do not cross, unless `wanted` gives the range of the left axis. A
/// vertical line marks the scene's own rate, and a cross its wall. `note` states the conditions of the
/// ripple.
///
/// # Errors
/// If there are fewer than two points.
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
    let height = |range: &Range<f64>| range.end / range.start;
    let left = stiffness.start / (height(&ripple) * APART * APART)..stiffness.end * APART;
    let right = ripple.start / APART..ripple.end * height(&stiffness) * APART * APART;
    let left = wanted.unwrap_or(left);
    let legend = ROW * (curves.len() as i32 + 3) + 10;
    let size = (SIZE.0, (SIZE.1 as i32 + legend) as u32);
    draw_sized(size, |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(title, text(TITLE))?;
        let (plot, below) = area.split_vertically(units(SIZE.1 as i32 - TITLE_ROOM));
        paint(&plot, curves, (rates, left, right), own)?;
        write_legend(&below, note, curves, own)
    })
}

fn paint(
    area: &Area<'_>,
    curves: &[DelayCurve],
    (rates, left, right): (Range<f64>, Range<f64>, Range<f64>),
    own: &Own,
) -> Drawn<()> {
    // One number format on all axes.
    let exponents = [&rates, &left, &right].iter().any(|r| !Scale::logarithmic(r).is_plain());
    let numbers = Scale::logarithmic(&right);
    let numbers = if exponents { numbers.with_exponents() } else { numbers };
    let mut chart = axes::chart(area)
        .right_y_label_area_size(RIGHT_LABELS)
        .build_cartesian_2d(rates.clone().log_scale(), left.clone().log_scale())?
        .set_secondary_coord(rates.clone().log_scale(), right.log_scale());
    let names = Axes::named("sample rate (Hz)", "largest certified stiffness (N m/rad)");
    Axes { most: (12, 11), exponents, ..names }.draw(&mut chart)?;
    chart
        .configure_secondary_axes()
        .axis_style(pen(1))
        .set_all_tick_mark_size(units(5))
        .y_desc("torque ripple of the encoder (N m)")
        .y_label_formatter(&|ripple| numbers.number(*ripple))
        .label_style(text(LABEL))
        .draw()?;
    for (index, curve) in curves.iter().enumerate() {
        let dash = Dash::of(index);
        let (main, second) = (chart.plotting_area(), chart.secondary_plotting_area());
        let seen = |p: &&Point| left.contains(&p.stiffness);
        let stiff = curve.points.iter().filter(seen);
        let stiff = stiff.map(|p| main.map_coordinate(&(p.rate, p.stiffness)));
        let ripple = curve.points.iter().filter_map(|p| Some((p.rate, p.ripple?)));
        let ripple = ripple.map(|point| second.map_coordinate(&point));
        let (x, y) = main.get_base_pixel();
        let area = main.strip_coord_spec();
        let place = |(px, py): (i32, i32)| (px - x, py - y);
        dash.draw(&area, &stiff.map(place).collect::<Vec<_>>(), 3)?;
        dash.draw(&area, &ripple.map(place).collect::<Vec<_>>(), 1)?;
    }
    if !rates.contains(&own.rate) && own.rate != rates.end {
        return Ok(());
    }
    let (main, area) = (chart.plotting_area(), chart.plotting_area().strip_coord_spec());
    let (x, y) = main.get_base_pixel();
    let place = |stiffness: f64| {
        let (px, py) = main.map_coordinate(&(own.rate, stiffness));
        (px - x, py - y)
    };
    Dash::new(&[3, 3]).draw(&area, &[place(left.start), place(left.end)], 1)?;
    let name = format!("{} Hz", significant(own.rate, 4));
    let beside = place(left.start);
    // On the side where there is room.
    let right = beside.0 > area.dim_in_pixel().0 as i32 / 2;
    let (side, gap) = if right { (HPos::Right, -units(6)) } else { (HPos::Left, units(6)) };
    let corner = (beside.0 + gap, beside.1 - units(8));
    area.draw(&Text::new(name, corner, anchored(side, VPos::Bottom)))?;
    if left.contains(&own.stiffness) {
        area.draw(&Cross::new(place(own.stiffness), units(7), WHITE.stroke_width(5 * UNITS)))?;
        area.draw(&Cross::new(place(own.stiffness), units(7), pen(2)))?;
    }
    Ok(())
}

fn write_legend(area: &Area<'_>, note: &str, curves: &[DelayCurve], own: &Own) -> Drawn<()> {
    let style = || anchored(HPos::Left, VPos::Center);
    let middle = |row: usize| units(ROW * row as i32 + ROW / 2);
    for (row, curve) in curves.iter().enumerate() {
        let y = middle(row);
        Dash::of(row).draw(area, &[(units(20), y), (units(90), y)], 2)?;
        let end = curve.points.last().map_or_else(
            || "nothing is certified".to_owned(),
            |last| {
                let (k, rate) = (significant(last.stiffness, 3), significant(last.rate, 3));
                format!("{k} N m/rad at {rate} Hz")
            },
        );
        let what = if curve.is_coupling { " (any wall: the coupling limits)" } else { "" };
        let words = format!("delay {}{what}: {end}", curve.delay);
        area.draw(&Text::new(words, (units(102), y), style()))?;
    }
    let Own { rate, stiffness, delay } = own;
    let (k, rate) = (significant(*stiffness, 4), significant(*rate, 5));
    let notes = [
        format!("cross: the scene, {k} N m/rad at {rate} Hz, delay {delay}"),
        "thick, left axis: stiffness; thin, right axis: ripple".to_owned(),
        note.to_owned(),
    ];
    for (row, note) in notes.into_iter().enumerate() {
        let place = (units(20), middle(curves.len() + row));
        area.draw(&Text::new(note, place, style()))?;
    }
    Ok(())
}
