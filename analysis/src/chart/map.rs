//! The map of walls over stiffness and damping.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::cell_polygons::polygons;
use super::hatch::Fill;
use super::*;
use crate::stability_map::border::Border;
use crate::stability_map::{Map, Region};

/// Height of a line of the legend in pixels.
const ROW: i32 = 22;

/// The additions to a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// Its title.
    pub title: String,
    /// The border by a closed form, if there is one.
    pub border: Option<Border>,
    /// Stiffness and damping of the scene itself.
    pub scene: (f64, f64),
}

/// Grey of a region: the better, the lighter. Hatching is on white.
fn grey(region: Region) -> RGBColor {
    match region {
        Region::Paper | Region::Undecided | Region::Wrong => WHITE,
        Region::Exact => RGBColor(214, 214, 214),
        Region::Rejected => RGBColor(160, 160, 160),
        Region::Unstable => RGBColor(96, 96, 96),
    }
}

/// The hatching of regions in which a verdict is missing or wrong.
fn hatching(region: Region) -> Option<Fill> {
    match region {
        Region::Undecided => Some(Fill::Rising),
        Region::Wrong => Some(Fill::Crossed),
        _ => None,
    }
}

/// The regions of the legend, the best first; rare ones only if present.
fn named(map: &Map) -> Vec<Region> {
    let is_named = |region: &Region| hatching(*region).is_none() || map.share(*region) > 0.0;
    Region::ALL.into_iter().rev().filter(is_named).collect()
}

/// Height in pixels of the map's legend.
fn legend(map: &Map, overlay: &Overlay) -> i32 {
    let entries = named(map).len() + usize::from(overlay.border.is_some()) + 1;
    ROW * entries.div_ceil(2) as i32 + 20
}

/// Draws a map: the regions in greys, their legend below, the border of the closed form as a broken
/// line, the scene as a cross.
///
/// # Errors
/// If the drawing fails.
pub fn map(map: &Map, overlay: &Overlay) -> Result<Picture, ChartError> {
    let size = (SIZE.0, SIZE.1 + legend(map, overlay) as u32);
    draw_sized(size, |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(&overlay.title, text(TITLE))?;
        let (plot, legend) = area.split_vertically(units(SIZE.1 as i32 - TITLE_ROOM));
        regions(&plot, map, overlay)?;
        write_legend(&legend, map, overlay)
    })
}

fn regions(area: &Area<'_>, map: &Map, overlay: &Overlay) -> Drawn<()> {
    let (x, y) = (map.stiffness.clone(), map.damping.clone());
    let mut chart =
        axes::chart(area).margin_right(MARGIN_RIGHT).build_cartesian_2d(x.clone(), y.clone())?;
    let place = |&(column, row): &(usize, usize)| {
        let along = |range: &Range<f64>, part: f64| range.start + (range.end - range.start) * part;
        let column = column as f64 / map.columns as f64;
        (along(&x, column), along(&y, row as f64 / map.rows as f64))
    };
    // Each region together with all better ones, the better ones on top.
    for region in Region::ALL {
        let cells = |column, row| map.at(column, row) >= region;
        for polygon in polygons(map.columns, map.rows, cells) {
            let corners: Vec<_> = polygon.iter().map(place).collect();
            // A thin line of the same grey closes the seams between parts of a region.
            let seam = [&corners[..], &corners[..1]].concat();
            let seam = PathElement::new(seam, grey(region).stroke_width(UNITS / 2));
            chart.draw_series([Polygon::new(corners, grey(region))])?;
            chart.draw_series([seam])?;
        }
    }
    hatch(&chart, map)?;
    Axes::named("stiffness (N m/rad)", "damping (N m s/rad)").draw(&mut chart)?;
    let axis = [(x.start, 0.0), (x.end, 0.0)];
    chart.draw_series([PathElement::new(axis, pen(1))])?;
    if let Some(Border { points, .. }) = &overlay.border {
        let white = WHITE.stroke_width(4 * UNITS);
        chart.draw_series(LineSeries::new(points.iter().copied(), white))?;
        chart.draw_series(broken(points.iter().copied(), 9, 6, 3))?;
    }
    let (k, b) = overlay.scene;
    if x.contains(&k) && y.contains(&b) {
        chart.draw_series([
            Cross::new((k, b), units(7), WHITE.stroke_width(5 * UNITS)),
            Cross::new((k, b), units(7), pen(2)),
        ])?;
    }
    Ok(())
}

/// Covers the regions that are hatched, column by column.
fn hatch(chart: &Plane<'_, '_>, map: &Map) -> Drawn<()> {
    let plot = chart.plotting_area();
    let area = plot.strip_coord_spec();
    let (width, height) = area.dim_in_pixel();
    let along = |size: u32, index: usize, of: usize| (size as usize * index / of) as i32;
    for column in 0..map.columns {
        let x = along(width, column, map.columns)..along(width, column + 1, map.columns);
        for row in 0..map.rows {
            let Some(fill) = hatching(map.at(column, row)) else { continue };
            let top = height as i32;
            let y = top - along(height, row + 1, map.rows)..top - along(height, row, map.rows);
            fill.draw(&area, &x, &y)?;
        }
    }
    Ok(())
}

/// The regions that the map has, each with its grey, then the lines and the cross.
fn write_legend(area: &Area<'_>, map: &Map, overlay: &Overlay) -> Drawn<()> {
    let cell = |index: usize| {
        (units(30 + 390 * (index % 2) as i32), units(ROW * (index / 2) as i32 + ROW / 2))
    };
    let style = || anchored(HPos::Left, VPos::Center);
    let regions = named(map);
    for (index, &region) in regions.iter().enumerate() {
        let (x, y) = cell(index);
        let corners = [(x, y - units(7)), (x + units(34), y + units(7))];
        area.draw(&Rectangle::new(corners, grey(region).filled()))?;
        if let Some(fill) = hatching(region) {
            fill.draw(area, &(x..x + units(34)), &(y - units(7)..y + units(7)))?;
        }
        area.draw(&Rectangle::new(corners, pen(1)))?;
        let share = crate::quantity::significant(100.0 * map.share(region), 3);
        let words = format!("{} ({share} %)", region.words());
        area.draw(&Text::new(words, (x + units(44), y), style()))?;
    }
    if let Some(border) = &overlay.border {
        let (x, y) = cell(regions.len());
        super::dash::Dash::of(4).draw(area, &[(x, y), (x + units(34), y)], 3)?;
        area.draw(&Text::new(border.name, (x + units(44), y), style()))?;
    }
    let (k, b) = overlay.scene;
    let (x, y) = cell(regions.len() + usize::from(overlay.border.is_some()));
    let seen = map.stiffness.contains(&k) && map.damping.contains(&b);
    if seen {
        area.draw(&Cross::new((x + units(17), y), units(7), pen(2)))?;
    }
    let words = if seen { "the scene" } else { "the scene lies outside the map" };
    area.draw(&Text::new(words, (x + units(44), y), style()))
}
