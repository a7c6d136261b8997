//! The springs that methods of integration show as stable, over their steps per tick.

use super::*;
use crate::simulation::method::Method;
use crate::studies::failures::region::{METHODS, Region};

/// Stiffness in N m/rad at the lower and the upper end of the picture.
const STIFFNESS: Range<f64> = 300.0..400_000.0;
/// The line of the true limit, and that of the certificate.
const TRUTH: Stroke = Stroke::solid(4);
const CERTIFIED: Stroke = Stroke::dashed(&[2, 4], 2);
/// Springs that a method calls unstable without need.
const NEEDLESS: Fill = Fill::Lines(&[Direction::Level]);

/// Draws the devices beside each other: curves of each method's largest stable stiffness, grey where a method
/// shows an unstable loop as stable, hatched where it shows a stable loop as unstable.
pub fn failures(regions: &[Region]) -> Result<Picture, ChartError> {
    let regions_and_lines = [
        (Sample::Region(Fill::Solid(FORBIDDEN)), "called stable, but unstable"),
        (Sample::Region(NEEDLESS), "called unstable, but stable"),
        (Sample::Line(TRUTH), "the truth"),
        (Sample::Line(CERTIFIED), "certified"),
    ];
    let methods = METHODS.map(|method| (Sample::Line(stroke(method)), method.name()));
    let page = Page::new("Stability limits by method of integration", &[HEIGHT]);
    page.legend(2, regions_and_lines.into_iter().chain(methods)).draw(|areas| {
        let areas = areas[0].split_evenly((1, regions.len()));
        areas.iter().zip(regions).try_for_each(|(area, region)| paint(area, region))
    })
}

fn paint(area: &Area<'_>, region: &Region) -> Drawn<()> {
    let steps = span(region.apparent.iter().flatten().map(|point| point.0));
    let (x, y) = (
        Axis::logarithmic(steps, "steps a tick"),
        Axis::logarithmic(STIFFNESS, "stiffness (N m/rad)"),
    );
    let mut panel = Panel::bare(area, region.device, x, y)?;
    shade(&panel, region)?;
    panel.grid()?;
    panel.level(TRUTH, region.truth)?;
    panel.level(CERTIFIED, region.certified)?;
    for (method, points) in METHODS.into_iter().zip(&region.apparent) {
        let seen = points.iter().map(|point| (point.0, point.1.max(STIFFNESS.start)));
        panel.curve(stroke(method), seen)?;
    }
    Ok(())
}

fn stroke(method: Method) -> Stroke {
    let pattern: &[i32] = match method {
        Method::Exact => &[],
        Method::SemiImplicit => &[11, 5],
        Method::Rk4 => &[12, 4, 2, 4],
        Method::Tustin => &[6, 3],
        Method::Euler => &[12, 4, 2, 4, 2, 4],
    };
    Stroke::dashed(pattern, 2)
}

/// Grey between the true limit and a larger limit of a method; hatched between the true limit and a smaller
/// one.
fn shade(panel: &Panel<'_, '_>, region: &Region) -> Drawn<()> {
    let columns = region.apparent[0].iter().enumerate().map(|(index, (steps, _))| {
        let all = region.apparent.iter().map(|points| points[index].1);
        let highest = all.clone().fold(region.truth, f64::max);
        (*steps, all.fold(region.truth, f64::min), highest)
    });
    let columns: Vec<(f64, f64, f64)> = columns.collect();
    let level = |stiffness: f64| columns.iter().rev().map(move |column| (column.0, stiffness));
    let highest = columns.iter().map(|column| (column.0, column.2));
    panel.fill(FORBIDDEN, highest.chain(level(region.truth)))?;
    // Hatched down to the axis, and white again below the lowest limit.
    let [right, bottom] = [panel.frame.right, panel.frame.bottom].map(|end| end as i32);
    let top = panel.point((1.0, region.truth)).1;
    NEEDLESS.draw(&panel.area, &(0..right), &(top..bottom))?;
    let lowest = columns.iter().map(|column| (column.0, column.1));
    panel.fill(WHITE, lowest.chain(level(STIFFNESS.start)))
}
