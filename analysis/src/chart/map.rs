//! The map of walls over stiffness and damping, and of other scenes over two numbers.

use super::cell_polygons::polygons;
use super::palette::REGIONS;
use super::*;
use crate::stability_map::border::Border;
use crate::stability_map::{Map, Region};

/// The line of a border by a closed form, and the white line below it.
const BORDER: Stroke = Stroke::dashed(&[9, 6], 3);
const BELOW: Stroke = Stroke::solid(4).ink(WHITE);
/// The line without damping.
const UNDAMPED: Stroke = Stroke::solid(1);

#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    pub title: String,
    /// The names of both numbers with their units.
    pub labels: [&'static str; 2],
    /// Whether the regions say whether a scene is stable.
    pub says_stability: bool,
    /// The border by a closed form, if there is one.
    pub border: Option<Border>,
    /// Both numbers of the scene itself.
    pub scene: (f64, f64),
}

/// Grey of a region: the better, the lighter; hatched on white where a verdict is missing or wrong.
fn fill(region: Region) -> Fill {
    match region {
        Region::Paper => Fill::Solid(WHITE),
        Region::Exact => Fill::Solid(REGIONS[0]),
        Region::Rejected => Fill::Solid(REGIONS[1]),
        Region::Unstable => Fill::Solid(REGIONS[2]),
        Region::Undecided => Fill::Lines(&[Direction::Rising]),
        Region::Wrong => Fill::Lines(&[Direction::Rising, Direction::Falling]),
    }
}

/// The regions of the legend, the best first; rare ones only if present.
fn named(map: &Map, overlay: &Overlay) -> Vec<Region> {
    let is_usual = |region| overlay.says_stability && matches!(fill(region), Fill::Solid(_));
    let is_named = |region: &Region| is_usual(*region) || map.share(*region) > 0.0;
    Region::ALL.into_iter().rev().filter(is_named).collect()
}

/// Draws a map: the regions in greys, the border of the closed form as a broken line, the scene as a cross.
pub fn map(map: &Map, overlay: &Overlay) -> Result<Picture, ChartError> {
    let [x, y] = overlay.labels;
    let (x, y) = (Axis::linear(map.x.clone(), x), Axis::linear(map.y.clone(), y));
    let is_seen = x.holds(overlay.scene.0) && y.holds(overlay.scene.1);
    let page = Page::new(&overlay.title, &[HEIGHT]);
    page.legend(2, legend(map, overlay, is_seen)).draw(|areas| {
        let mut panel = Panel::bare(&areas[0], "", x, y)?;
        regions(&panel, map)?;
        hatch(&panel, map)?;
        panel.grid()?;
        panel.level(UNDAMPED, 0.0)?;
        if let Some(Border { points, .. }) = &overlay.border {
            panel.curve(BELOW, points.iter().copied())?;
            panel.curve(BORDER, points.iter().copied())?;
        }
        panel.mark(Mark::SCENE, overlay.scene)
    })
}

fn regions(panel: &Panel<'_, '_>, map: &Map) -> Drawn<()> {
    let along = |range: &Range<f64>, index: usize, of: usize| {
        range.start + (range.end - range.start) * (index as f64 / of as f64)
    };
    let corner = |&(column, row): &(usize, usize)| {
        (along(&map.x, column, map.columns), along(&map.y, row, map.rows))
    };
    // Each region together with all better ones, the better ones on top.
    for region in Region::ALL {
        let cells = |column, row| map.at(column, row) >= region;
        let grey = if let Fill::Solid(grey) = fill(region) { grey } else { WHITE };
        for polygon in polygons(map.columns, map.rows, cells) {
            panel.fill(grey, polygon.iter().map(corner))?;
            // A thin line of the same grey closes the seams between parts of a region.
            let seam = polygon.iter().chain(&polygon[..1]).map(corner);
            panel.curve(Stroke::solid(1).ink(grey), seam)?;
        }
    }
    Ok(())
}

/// Covers the regions that are hatched, cell by cell.
fn hatch(panel: &Panel<'_, '_>, map: &Map) -> Drawn<()> {
    let [width, height] = [panel.frame.right, panel.frame.bottom].map(|size| size as usize);
    let along = |size: usize, index: usize, of: usize| (size * index / of) as i32;
    for column in 0..map.columns {
        let x = along(width, column, map.columns)..along(width, column + 1, map.columns);
        for row in 0..map.rows {
            let fill @ Fill::Lines(_) = fill(map.at(column, row)) else { continue };
            // Rows are counted from below.
            let top = map.rows - 1 - row;
            let y = along(height, top, map.rows)..along(height, top + 1, map.rows);
            fill.draw(&panel.area, &x, &y)?;
        }
    }
    Ok(())
}

/// The regions that the map has with their shares, then the lines and the cross.
fn legend(map: &Map, overlay: &Overlay, is_seen: bool) -> Vec<(Sample, String)> {
    let region = |region: Region| {
        let share = crate::quantity::significant(100.0 * map.share(region), 3);
        (
            Sample::Region(fill(region)),
            format!("{} ({share} %)", region.words(overlay.says_stability)),
        )
    };
    let border = overlay.border.as_ref();
    let border = border.map(|border| (Sample::Line(BORDER), border.name.to_owned()));
    let regions = named(map, overlay).into_iter().map(region);
    let scene = Sample::Point(Mark::SCENE).entry(is_seen, "the scene".to_owned());
    regions.chain(border).chain([scene]).collect()
}
