//! Places names beside points and lines without overlaps, if there is room.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::base::{Area, Drawn, LABEL, UNITS, units, write};

/// Width of a letter relative to the size of its font: more than the mean of the used letters, so that a name
/// is never longer than its block.
const LETTER: f64 = 0.52;
/// Distance between a point and its name.
const GAP: i32 = units(7);
/// Distance between a line and a name.
const BESIDE: i32 = units(1);
/// Up to this distance a name is next to its point; beyond it a line leads there.
const NEAR: f64 = (2 * GAP) as f64;
/// Points at this distance count as one place.
const SAME: f64 = units(3) as f64;
/// A name belongs to its point if other points are this many times farther away.
const OWN: f64 = 1.5;
/// Distance of a leader line from other points.
const PAST: f64 = units(6) as f64;
/// Points along a leader line at which collisions are tested.
const STEPS: i32 = 20;
/// Directions of the search for a place, first to the right and above.
const DIRECTIONS: usize = 32;
/// Distances of the search, each one line further.
const DISTANCES: i32 = 9;

/// A used rectangle, in units of the drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Block {
    /// From its upper left to its lower right corner.
    pub fn new((left, top): (i32, i32), (right, bottom): (i32, i32)) -> Self {
        Self { left, top, right, bottom }
    }

    /// All places at most `reach` beside a vertical or horizontal line, or a point.
    fn around(a: (i32, i32), b: (i32, i32), reach: i32) -> Self {
        let (left, top) = (a.0.min(b.0) - reach, a.1.min(b.1) - reach);
        Self { left, top, right: a.0.max(b.0) + reach, bottom: a.1.max(b.1) + reach }
    }

    /// The height of its middle.
    fn middle(&self) -> i32 {
        (self.top + self.bottom) / 2
    }

    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// The distance of a point from it.
    fn distance(&self, (x, y): (i32, i32)) -> f64 {
        distance((x, y), self.nearest((x, y)))
    }

    fn nearest(&self, (x, y): (i32, i32)) -> (i32, i32) {
        (x.clamp(self.left, self.right), y.clamp(self.top, self.bottom))
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }
}

/// Used space of a panel.
#[derive(Clone, Debug)]
pub struct Labels {
    panel: Block,
    taken: Vec<Block>,
    names: Vec<Block>,
    points: Vec<(i32, i32)>,
}

impl Labels {
    pub fn within(panel: Block) -> Self {
        Self { panel, taken: Vec::new(), names: Vec::new(), points: Vec::new() }
    }

    /// Keeps other names away from a point, so that no other name is taken for its name.
    pub fn mark(&mut self, point: (i32, i32), reach: i32) {
        self.taken.push(Block::around(point, point, reach));
        self.points.push(point);
    }

    /// Keeps names away from a line.
    pub fn keep_clear_of(&mut self, line: &[(i32, i32)], reach: i32) {
        let steps = |from, to| (distance(from, to) / f64::from(reach)).ceil().max(1.0) as i32;
        for pair in line.windows(2) {
            let steps = steps(pair[0], pair[1]);
            let points = (0..=steps).map(|step| along(pair, (step, steps)));
            self.taken.extend(points.map(|point| Block::around(point, point, reach)));
        }
    }

    /// Keeps names off a vertical or horizontal line.
    pub fn keep_clear_along(&mut self, from: (i32, i32), to: (i32, i32)) {
        self.taken.push(Block::around(from, to, BESIDE));
    }

    /// The points at more than this distance from one of them.
    fn beyond(&self, reach: f64, point: (i32, i32)) -> impl Iterator<Item = (i32, i32)> {
        self.points.iter().copied().filter(move |&other| distance(point, other) > reach)
    }

    /// The nearest place to a point where a name of this size fits and belongs to the point; otherwise a
    /// place that needs a leader line to the point, and `true`. `None` if the panel is full.
    fn place(&self, point: (i32, i32), (width, height): (i32, i32)) -> Option<(Block, bool)> {
        let (x, y) = point;
        let around = (0..DISTANCES).flat_map(|distance| {
            (0..DIRECTIONS).map(move |direction| {
                let turn = std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64;
                // Up and to the right first, then to both sides alternately.
                let angle = std::f64::consts::FRAC_PI_4
                    + if direction % 2 == 0 { 0.5 } else { -0.5 } * turn;
                (distance, angle)
            })
        });
        let block = |(distance, angle): (i32, f64)| {
            let reach = f64::from(GAP + distance * height);
            // In diagonal directions its corner is nearest to the point; in vertical and horizontal
            // directions its middle.
            let away = |part: f64, size: i32| {
                let side = (part * std::f64::consts::SQRT_2).clamp(-1.0, 1.0);
                part * reach + 0.5 * side * f64::from(size)
            };
            let middle =
                (f64::from(x) + away(angle.cos(), width), f64::from(y) - away(angle.sin(), height));
            let corner = (middle.0 as i32 - width / 2, middle.1 as i32 - height / 2);
            Block::new(corner, (corner.0 + width, corner.1 + height))
        };
        let free = || around.clone().map(block).filter(|block| self.is_free(block));
        let own = free().find(|b| b.distance(point) <= NEAR && self.is_own(point, b));
        let led = || free().filter(|b| b.distance(point) >= NEAR && self.can_lead(point, b));
        let alone = |b: &Block| self.beyond(SAME, point).all(|other| b.distance(other) >= NEAR);
        let far = || led().find(alone).or_else(|| led().next()).or_else(|| free().next());
        own.map(|block| (block, false)).or_else(|| far().map(|block| (block, true)))
    }

    /// Whether a name there is closest to its own point.
    fn is_own(&self, point: (i32, i32), block: &Block) -> bool {
        let own = block.distance(point);
        self.beyond(SAME, point).all(|other| block.distance(other) >= OWN * own)
    }

    /// Whether a line from there to the point passes no other point and no name.
    fn can_lead(&self, point: (i32, i32), block: &Block) -> bool {
        let line = [point, block.nearest(point)];
        let others: Vec<_> = self.beyond(PAST, point).collect();
        (0..=STEPS).map(|step| along(&line, (step, STEPS))).all(|at| {
            let on = |name: &Block| name.meets(&Block::around(at, at, 1));
            !self.names.iter().any(on) && others.iter().all(|&other| distance(at, other) > PAST)
        })
    }

    fn is_free(&self, block: &Block) -> bool {
        self.panel.holds(block) && !self.taken.iter().any(|taken| taken.meets(block))
    }

    fn take(&mut self, block: Block) {
        self.taken.push(block);
        self.names.push(block);
    }

    /// Writes a word above or below a level line, as far to the left as possible.
    pub fn write_beside(&mut self, area: &Area<'_>, y: i32, word: &str) -> Drawn<()> {
        let width = width_of(word);
        let column = |left: i32| [y - LABEL - BESIDE, y + 2 * BESIDE].map(|top| (left, top));
        let corners = (self.panel.left..self.panel.right).step_by(GAP as usize).flat_map(column);
        let block = |(x, y): (i32, i32)| Block::new((x, y), (x + width, y + LABEL));
        let free = corners.map(block).find(|block| self.is_free(block));
        let Some(block) = free else { return Ok(()) };
        self.take(block);
        write(area, (block.left + BESIDE, block.middle()), HPos::Left, word)
    }

    /// Writes a name beside a point, with a thin leader line if it is far away or nearer to another point.
    pub fn write(&mut self, area: &Area<'_>, point: (i32, i32), name: &str) -> Drawn<()> {
        let size = (width_of(name), LABEL);
        let Some((block, is_led)) = self.place(point, size) else { return Ok(()) };
        self.take(block);
        if is_led {
            let line = BLACK.mix(0.7).stroke_width(UNITS * 3 / 4);
            area.draw(&PathElement::new(vec![point, block.nearest(point)], line))?;
        }
        // On the side towards its point.
        let quarter = (block.right - block.left) / 4;
        let (side, edge) = match point.0 {
            x if x <= block.left + quarter => (HPos::Left, block.left),
            x if x >= block.right - quarter => (HPos::Right, block.right),
            _ => (HPos::Center, (block.left + block.right) / 2),
        };
        write(area, (edge, block.middle()), side, name)
    }
}

/// Upper estimate of the width of a name.
fn width_of(name: &str) -> i32 {
    (name.chars().count() as f64 * LETTER * f64::from(LABEL)) as i32
}

fn distance(a: (i32, i32), b: (i32, i32)) -> f64 {
    f64::from(a.0 - b.0).hypot(f64::from(a.1 - b.1))
}

/// The point after a number of steps from the first of two points to the second.
fn along(pair: &[(i32, i32)], (step, steps): (i32, i32)) -> (i32, i32) {
    let part = f64::from(step) / f64::from(steps);
    let mix = |a: i32, b: i32| a + (part * f64::from(b - a)).round() as i32;
    (mix(pair[0].0, pair[1].0), mix(pair[0].1, pair[1].1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_the_panel_and_on_nothing_else() {
        let panel = Block::new((0, 0), (units(400), units(300)));
        let mut labels = Labels::within(panel);
        let points: Vec<_> = (0..12).map(|i| (units(20 * i + 40), units(10 * i + 60))).collect();
        points.iter().for_each(|&point| labels.mark(point, units(4)));
        let size = (units(90), units(13));
        let mut place = |&point: &(i32, i32)| {
            let (found, _) = labels.place(point, size).unwrap();
            labels.take(found);
            found
        };
        let placed: Vec<_> = points.iter().map(&mut place).collect();
        for (index, block) in labels.taken.iter().enumerate() {
            assert!(panel.holds(block));
            let names = placed.iter().filter(|name| *name != block);
            assert!(index < points.len() || !names.clone().any(|name| name.meets(block)));
            assert!(index >= points.len() || !placed.iter().any(|name| name.meets(block)));
        }
        // Where there is no room there is no name.
        assert_eq!(labels.place((0, 0), (units(500), units(13))), None);
    }

    #[test]
    fn a_name_is_nearest_to_its_own_point_or_a_line_leads_there() {
        let mut labels = Labels::within(Block::new((0, 0), (units(400), units(300))));
        let row = |i: i32| (units(150 + 12 * i), units(150));
        let points: Vec<_> = (0..9).map(row).chain([(units(300), units(80))]).collect();
        points.iter().for_each(|&point| labels.mark(point, units(4)));
        let mut led = Vec::new();
        for &point in &points {
            let (block, is_led) = labels.place(point, (units(50), units(13))).unwrap();
            labels.take(block);
            let others = points.iter().filter(|other| **other != point);
            let nearest = others.map(|other| block.distance(*other)).fold(1e9, f64::min);
            assert!(is_led || block.distance(point) < nearest, "{point:?} {block:?}");
            led.push(is_led);
        }
        assert!(led[4] && !led[9], "{led:?}");
    }
}
