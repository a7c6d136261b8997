//! The map of torque profiles over their number of repetitions in a turn and their torque.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::Dash;
use super::*;
use crate::profile_curve::DetentLimits;

/// Height of a line of the legend in pixels.
const ROW: i32 = 22;

/// The data of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct DetentMap {
    /// Its title.
    pub title: String,
    /// The scene's own limit.
    pub own: DetentLimits,
    /// The limits of other delays.
    pub others: Vec<DetentLimits>,
    /// Number of repetitions and torque of the scene itself.
    pub scene: (f64, f64),
    /// Range of the number of repetitions.
    pub counts: Range<f64>,
    /// Range of the torque in N m.
    pub torques: Range<f64>,
}

/// Draws a map: the certified region is white.
///
/// # Errors
/// If there is nothing to draw.
pub fn detents(map: &DetentMap) -> Result<Picture, ChartError> {
    if map.own.points.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    let rows = 3 + map.others.len() as i32;
    draw_sized((SIZE.0, SIZE.1 + (ROW * rows + 20) as u32), |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(&map.title, text(TITLE))?;
        let (plot, legend) = area.split_vertically(units(SIZE.1 as i32 - TITLE_ROOM));
        paint(&plot, map)?;
        write_legend(&legend, map)
    })
}

fn paint(area: &Area<'_>, map: &DetentMap) -> Drawn<()> {
    let (x, y) = (map.counts.clone(), map.torques.clone());
    let mut chart =
        axes::chart(area).margin_right(MARGIN_RIGHT).build_cartesian_2d(x.clone(), y.clone())?;
    let line = |limits: &DetentLimits| below(&limits.points, y.end);
    let own = line(&map.own);
    if let (Some(first), Some(last)) = (own.first(), own.last()) {
        let mut above = own.clone();
        above.extend([(last.0, y.end), (first.0, y.end)]);
        chart.draw_series([Polygon::new(above, FORBIDDEN)])?;
    }
    let names = Axes::named("repetitions in a turn", "torque (N m)");
    names.draw(&mut chart)?;
    chart.draw_series(LineSeries::new(own.iter().copied(), pen(2)))?;
    let (plane, area) = (chart.plotting_area(), chart.plotting_area().strip_coord_spec());
    let base = plane.get_base_pixel();
    let place = |point: &(f64, f64)| {
        let (px, py) = plane.map_coordinate(point);
        (px - base.0, py - base.1)
    };
    for (index, other) in map.others.iter().enumerate().filter(|(_, other)| !is_same(map, other)) {
        let points: Vec<_> = line(other).iter().map(place).collect();
        Dash::of(index + 1).draw(&area, &points, 1)?;
    }
    if is_seen(map) {
        let at = place(&map.scene);
        area.draw(&Cross::new(at, units(7), WHITE.stroke_width(5 * UNITS)))?;
        area.draw(&Cross::new(at, units(7), pen(2)))?;
    }
    Ok(())
}

/// The part of a falling curve below a torque, from the crossing on.
fn below(points: &[(f64, f64)], most: f64) -> Vec<(f64, f64)> {
    let first = points.iter().position(|point| point.1 <= most).unwrap_or(points.len());
    let crossing = first.checked_sub(1).zip(points.get(first)).map(|(before, &(x, y))| {
        let (from, above) = points[before];
        (from + (x - from) * (above - most) / (above - y), most)
    });
    crossing.into_iter().chain(points[first..].iter().copied()).collect()
}

/// Whether another delay has the same limit, so that its line would hide in the other.
fn is_same(map: &DetentMap, other: &DetentLimits) -> bool {
    let mut pairs = map.own.points.iter().zip(&other.points);
    map.own.points.len() == other.points.len()
        && pairs.all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() <= 1e-3 * a.1)
}

fn is_seen(map: &DetentMap) -> bool {
    map.counts.contains(&map.scene.0) && map.torques.contains(&map.scene.1)
}

fn write_legend(area: &Area<'_>, map: &DetentMap) -> Drawn<()> {
    let place = |row: usize| (units(30), units(ROW * row as i32 + ROW / 2));
    let words = |row: usize, words: String| {
        let (x, y) = place(row);
        area.draw(&Text::new(words, (x + units(72), y), anchored(HPos::Left, VPos::Center)))
    };
    let (x, y) = place(0);
    Dash::of(0).draw(area, &[(x, y), (x + units(60), y)], 2)?;
    words(0, format!("largest torque that certifies with the scene's delay, {}", map.own.delay))?;
    let (x, y) = place(1);
    let corners = [(x, y - units(7)), (x + units(60), y + units(7))];
    area.draw(&Rectangle::new(corners, FORBIDDEN.filled()))?;
    area.draw(&Rectangle::new(corners, pen(1)))?;
    words(1, "not certified".to_owned())?;
    for (index, other) in map.others.iter().enumerate() {
        let (x, y) = place(index + 2);
        if other.points.is_empty() {
            words(index + 2, format!("no torque certifies with a delay of {}", other.delay))?;
            continue;
        }
        if is_same(map, other) {
            words(index + 2, format!("the same with a delay of {}", other.delay))?;
            continue;
        }
        Dash::of(index + 1).draw(area, &[(x, y), (x + units(60), y)], 1)?;
        words(index + 2, format!("largest torque that certifies with a delay of {}", other.delay))?;
    }
    let row = map.others.len() + 2;
    let (x, y) = place(row);
    let seen = is_seen(map);
    if seen {
        area.draw(&Cross::new((x + units(30), y), units(7), pen(2)))?;
    }
    let said = if seen { "the scene" } else { "the scene lies outside the map" };
    words(row, said.to_owned())
}
