//! The springs that methods of integration show as stable, over their steps per tick.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::{Dash, SOLID};
use super::*;
use crate::simulation::method::Method;
use crate::studies::failures::region::{METHODS, Region};

/// Height of a line of the legend in pixels.
const ROW: i32 = 22;
/// Lines of the legend.
const ROWS: i32 = 4;
/// Stiffness in N m/rad at the lower and the upper end of the picture.
const STIFFNESS: Range<f64> = 300.0..400_000.0;
/// Pixels between the lines of a hatching.
const SPACING: i32 = units(6);
/// Grey of these lines.
const INK: RGBColor = RGBColor(150, 150, 150);

type LogPlane<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<
        plotters::coord::combinators::LogCoord<f64>,
        plotters::coord::combinators::LogCoord<f64>,
    >,
>;

/// Draws the devices beside each other: curves of each method's largest stable stiffness, grey where a method
/// shows an unstable loop as stable, hatched where it shows a stable loop as unstable.
///
/// # Errors
/// If it cannot be drawn.
pub fn failures(regions: &[Region]) -> Result<Picture, ChartError> {
    let size = (SIZE.0, (SIZE.1 as i32 + ROW * ROWS - 20) as u32);
    draw_sized(size, |area| {
        let title = "Stability limits by method of integration";
        let area = area.margin(units(TOP), 0, 0, 0).titled(title, text(TITLE))?;
        let (plots, legend) = area.split_vertically(units(SIZE.1 as i32 - TITLE_ROOM - 20));
        let panels = plots.split_evenly((1, regions.len()));
        for (panel, region) in panels.iter().zip(regions) {
            paint(panel, region)?;
        }
        write_legend(&legend)
    })
}

fn paint(area: &Area<'_>, region: &Region) -> Drawn<()> {
    let steps = region.apparent.iter().flatten().map(|point| point.0);
    let steps = span(steps);
    let mut chart = axes::chart(area)
        .caption(region.device, text(LABEL))
        .build_cartesian_2d(steps.clone().log_scale(), STIFFNESS.log_scale())?;
    shade(&mut chart, region)?;
    let names = Axes::named("steps a tick", "stiffness (N m/rad)");
    Axes { most: (4, 11), ..names }.draw(&mut chart)?;
    let level = |stiffness: f64| vec![(steps.start, stiffness), (steps.end, stiffness)];
    line(&chart, &level(region.truth), SOLID, 4)?;
    line(&chart, &level(region.certified), CERTIFIED, 2)?;
    for (method, points) in METHODS.into_iter().zip(&region.apparent) {
        let seen = points.iter().map(|point| (point.0, point.1.max(STIFFNESS.start)));
        line(&chart, &seen.collect::<Vec<_>>(), dash(method), 2)?;
    }
    Ok(())
}

/// The line of the certificate.
const CERTIFIED: Dash = Dash::new(&[2, 4]);

/// The line of a method.
fn dash(method: Method) -> Dash {
    Dash::new(match method {
        Method::Exact => &[],
        Method::SemiImplicit => &[11, 5],
        Method::Rk4 => &[12, 4, 2, 4],
        Method::Tustin => &[6, 3],
        Method::Euler => &[12, 4, 2, 4, 2, 4],
    })
}

/// A line through points, in the pattern of a dash.
fn line(chart: &LogPlane<'_, '_>, points: &[(f64, f64)], dash: Dash, width: u32) -> Drawn<()> {
    let plot = chart.plotting_area();
    let (x, y) = plot.get_base_pixel();
    let own = |point: &(f64, f64)| {
        let (px, py) = plot.map_coordinate(point);
        (px - x, py - y)
    };
    dash.draw(&plot.strip_coord_spec(), &points.iter().map(own).collect::<Vec<_>>(), width)
}

/// Grey between the true limit and a larger limit of a method; hatched between the true limit and a smaller
/// one.
fn shade(chart: &mut LogPlane<'_, '_>, region: &Region) -> Drawn<()> {
    let columns = (0..region.apparent[0].len()).map(|index| {
        let all = region.apparent.iter().map(|points| points[index].1);
        let highest = all.clone().fold(region.truth, f64::max).min(STIFFNESS.end);
        let lowest = all.fold(region.truth, f64::min).max(STIFFNESS.start);
        (region.apparent[0][index].0, lowest, highest)
    });
    let columns: Vec<(f64, f64, f64)> = columns.collect();
    let truth = columns.iter().rev().map(|column| (column.0, region.truth));
    let above: Vec<_> = columns.iter().map(|column| (column.0, column.2)).chain(truth).collect();
    chart.draw_series([Polygon::new(above, FORBIDDEN.filled())])?;
    let plot = chart.plotting_area();
    let (left, top) = plot.get_base_pixel();
    let pixel = |point: (f64, f64)| {
        let (x, y) = plot.map_coordinate(&point);
        (x - left, y - top)
    };
    let below: Vec<(i32, i32)> = columns.iter().map(|column| pixel((column.0, column.1))).collect();
    let ceiling = pixel((columns[0].0, region.truth)).1;
    let area = plot.strip_coord_spec();
    let lowest = below.iter().map(|point| point.1).max().unwrap_or(ceiling);
    for level in (ceiling..lowest).step_by(SPACING as usize).skip(1) {
        for (from, to) in runs(&below, level) {
            let ends = vec![(from, level), (to, level)];
            area.draw(&PathElement::new(ends, INK.stroke_width(UNITS)))?;
        }
    }
    Ok(())
}

/// The intervals in which a level line lies above a line through points (with ordinates downwards).
fn runs(line: &[(i32, i32)], level: i32) -> Vec<(i32, i32)> {
    let mut runs = Vec::new();
    for pair in line.windows(2) {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        let part = |y: i32| f64::from(y - y0) / f64::from(y1 - y0);
        let crossing = || x0 + (part(level) * f64::from(x1 - x0)) as i32;
        match (y0 > level, y1 > level) {
            (true, true) => runs.push((x0, x1)),
            (true, false) => runs.push((x0, crossing())),
            (false, true) => runs.push((crossing(), x1)),
            (false, false) => {}
        }
    }
    runs
}

fn write_legend(area: &Area<'_>) -> Drawn<()> {
    let style = || anchored(HPos::Left, VPos::Center);
    let cell = |index: i32| (units(30 + 400 * (index % 2)), units(ROW * (index / 2) + ROW / 2));
    let (x, y) = cell(0);
    let grey = [(x, y - units(7)), (x + units(60), y + units(7))];
    area.draw(&Rectangle::new(grey, FORBIDDEN.filled()))?;
    let (hx, hy) = cell(1);
    for offset in [-6, 0, 6] {
        let ends = vec![(hx, hy + units(offset)), (hx + units(60), hy + units(offset))];
        area.draw(&PathElement::new(ends, INK.stroke_width(UNITS)))?;
    }
    let lines = [(SOLID, 4), (CERTIFIED, 2)].into_iter();
    let methods = METHODS.into_iter().map(|method| (dash(method), 2));
    for (index, (dash, width)) in lines.chain(methods).enumerate() {
        let (x, y) = cell(index as i32 + 2);
        dash.draw(area, &[(x, y), (x + units(60), y)], width)?;
    }
    let methods = METHODS.map(Method::name);
    let words =
        ["called stable, but unstable", "called unstable, but stable", "the truth", "certified"];
    for (index, words) in words.into_iter().chain(methods).enumerate() {
        let (x, y) = cell(index as i32);
        area.draw(&Text::new(words, (x + units(70), y), style()))?;
    }
    Ok(())
}
