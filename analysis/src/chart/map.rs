//! The map of walls over stiffness and damping.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::strips::polygons;
use super::*;
use crate::map::{Map, Region};

/// Height in pixels of the map's key, of two lines with a border's and a scene's.
const KEY: i32 = 86;
/// Height of a line of the key in pixels.
const ROW: i32 = 22;

/// What a map is drawn with.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// What it is called.
    pub title: String,
    /// Stiffness and damping along the closed form's border; empty where there is none.
    pub border: Vec<(f64, f64)>,
    /// Stiffness and damping of the scene itself.
    pub scene: (f64, f64),
}

/// Grey of a region: the better, the lighter.
fn grey(region: Region) -> RGBColor {
    match region {
        Region::Paper => WHITE,
        Region::Exact => RGBColor(214, 214, 214),
        Region::Stable => RGBColor(160, 160, 160),
        Region::Unstable => RGBColor(96, 96, 96),
    }
}

fn name(region: Region) -> &'static str {
    match region {
        Region::Paper => "certified by the paper's rule",
        Region::Exact => "certified by the exact rule only",
        Region::Stable => "stable with no hand, not certified",
        Region::Unstable => "unstable with no hand",
    }
}

/// Draws a map: the regions in greys, their key below, the border of the closed form as a broken
/// line, the scene as a cross.
///
/// # Errors
/// Where the drawing fails.
pub fn map(map: &Map, overlay: &Overlay) -> Result<Picture, ChartError> {
    let size = (SIZE.0, SIZE.1 + KEY as u32);
    draw_sized(size, |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(&overlay.title, text(TITLE))?;
        let (plot, key) = area.split_vertically(units(SIZE.1 as i32 - TITLE_ROOM));
        regions(&plot, map, overlay)?;
        write_key(&key, map, overlay)
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
    // Each region with all that are better, the better ones on top.
    for region in Region::ALL {
        let cells = |column, row| map.at(column, row) >= region;
        for polygon in polygons(map.columns, map.rows, cells) {
            let corners: Vec<_> = polygon.iter().map(place).collect();
            // A hair of the same grey around it closes the seams between parts of a region.
            let seam = [&corners[..], &corners[..1]].concat();
            let seam = PathElement::new(seam, grey(region).stroke_width(UNITS / 2));
            chart.draw_series([Polygon::new(corners, grey(region))])?;
            chart.draw_series([seam])?;
        }
    }
    Axes::named("stiffness (N m/rad)", "damping (N m s/rad)").draw(&mut chart)?;
    let axis = [(x.start, 0.0), (x.end, 0.0)];
    chart.draw_series([PathElement::new(axis, pen(1))])?;
    let on_white = overlay.border.iter().copied();
    chart.draw_series(LineSeries::new(on_white, WHITE.stroke_width(4 * UNITS)))?;
    chart.draw_series(broken(overlay.border.iter().copied(), 9, 6, 3))?;
    let (k, b) = overlay.scene;
    if x.contains(&k) && y.contains(&b) {
        chart.draw_series([
            Cross::new((k, b), units(7), WHITE.stroke_width(5 * UNITS)),
            Cross::new((k, b), units(7), pen(2)),
        ])?;
    }
    Ok(())
}

/// The regions that the map has, each with its grey, then the lines and the cross.
fn write_key(area: &Area<'_>, map: &Map, overlay: &Overlay) -> Drawn<()> {
    let cell = |index: usize| {
        (units(30 + 390 * (index % 2) as i32), units(ROW * (index / 2) as i32 + ROW / 2))
    };
    let style = || anchored(HPos::Left, VPos::Center);
    for (index, region) in Region::ALL.into_iter().rev().enumerate() {
        let (x, y) = cell(index);
        let corners = [(x, y - units(7)), (x + units(34), y + units(7))];
        area.draw(&Rectangle::new(corners, grey(region).filled()))?;
        area.draw(&Rectangle::new(corners, pen(1)))?;
        let share = crate::quantity::significant(100.0 * map.share(region), 3);
        let words = format!("{} ({share} %)", name(region));
        area.draw(&Text::new(words, (x + units(44), y), style()))?;
    }
    if !overlay.border.is_empty() {
        let (x, y) = cell(4);
        super::dash::Dash::of(4).draw(area, &[(x, y), (x + units(34), y)], 3)?;
        let words = "closed form of the paper's border";
        area.draw(&Text::new(words, (x + units(44), y), style()))?;
    }
    let (k, b) = overlay.scene;
    let (x, y) = cell(5);
    let seen = map.stiffness.contains(&k) && map.damping.contains(&b);
    if seen {
        area.draw(&Cross::new((x + units(17), y), units(7), pen(2)))?;
    }
    let words = if seen { "the scene" } else { "the scene lies outside the map" };
    area.draw(&Text::new(words, (x + units(44), y), style()))
}
