//! Names beside points, none of them on another or on a point.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::chart::{Area, Drawn, FONT, UNITS, units};

/// Width of a letter over the size of its font: more than the mean of the letters in use, so that
/// a name is never longer than its block.
const LETTER: f64 = 0.6;
/// Between a point and its name.
const GAP: i32 = units(7);
/// Between a line and a name.
const BESIDE: i32 = units(1);
/// Directions in which a place is looked for, first to the right and above.
const DIRECTIONS: usize = 16;
/// Distances at which it is looked for, each one line further.
const DISTANCES: i32 = 9;

/// A rectangle that is taken, in units of the drawing.
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

    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }
}

/// What is taken of a panel.
#[derive(Clone, Debug)]
pub struct Labels {
    panel: Block,
    taken: Vec<Block>,
}

impl Labels {
    /// An empty panel.
    pub fn within(panel: Block) -> Self {
        Self { panel, taken: Vec::new() }
    }

    /// Lets no name come so near a point.
    pub fn keep_clear(&mut self, (x, y): (i32, i32), reach: i32) {
        self.taken.push(Block::new((x - reach, y - reach), (x + reach, y + reach)));
    }

    /// Lets no name be across a line that is upright or level.
    pub fn keep_clear_along(&mut self, from: (i32, i32), to: (i32, i32)) {
        let (left, right) = (from.0.min(to.0), from.0.max(to.0));
        let (top, bottom) = (from.1.min(to.1), from.1.max(to.1));
        self.taken
            .push(Block::new((left - BESIDE, top - BESIDE), (right + BESIDE, bottom + BESIDE)));
    }

    /// The nearest place to a point where a name of that size fits; `None` where the panel is full.
    fn place(&self, (x, y): (i32, i32), (width, height): (i32, i32)) -> Option<Block> {
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
            let middle = (
                f64::from(x) + angle.cos() * (reach + 0.5 * f64::from(width)),
                f64::from(y) - angle.sin() * (reach + 0.5 * f64::from(height)),
            );
            let corner = (middle.0 as i32 - width / 2, middle.1 as i32 - height / 2);
            Block::new(corner, (corner.0 + width, corner.1 + height))
        };
        around.map(block).find(|block| self.is_free(block))
    }

    fn is_free(&self, block: &Block) -> bool {
        self.panel.holds(block) && !self.taken.iter().any(|taken| taken.meets(block))
    }

    /// Takes a block and writes in it.
    fn fill(&mut self, area: &Area<'_>, block: Block, name: &str, size: i32) -> Drawn<()> {
        self.taken.push(block);
        let middle = ((block.left + block.right) / 2, (block.top + block.bottom) / 2);
        let style = TextStyle::from((FONT, size)).color(&BLACK);
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        area.draw(&Text::new(name.to_owned(), middle, style))
    }

    /// Writes a word beside a level line, above or below it, as far to the left as there is room.
    pub fn write_beside(&mut self, area: &Area<'_>, y: i32, word: &str, size: i32) -> Drawn<()> {
        let (width, height) = (width_of(word, size), size);
        let column = |left: i32| [y - height - BESIDE, y + 2 * BESIDE].map(|top| (left, top));
        let corners = (self.panel.left..self.panel.right).step_by(GAP as usize).flat_map(column);
        let block = |(x, y): (i32, i32)| Block::new((x, y), (x + width, y + height));
        match corners.map(block).find(|block| self.is_free(block)) {
            Some(block) => self.fill(area, block, word, size),
            None => Ok(()),
        }
    }

    /// Writes a name beside a point, with a thin line to it where it had to go far.
    pub fn write(
        &mut self,
        area: &Area<'_>,
        point: (i32, i32),
        name: &str,
        size: i32,
    ) -> Drawn<()> {
        let Some(block) = self.place(point, (width_of(name, size), size)) else { return Ok(()) };
        let nearest =
            (point.0.clamp(block.left, block.right), point.1.clamp(block.top, block.bottom));
        let far = (nearest.0 - point.0).abs().max((nearest.1 - point.1).abs()) > 2 * GAP;
        if far {
            let line = BLACK.mix(0.4).stroke_width(UNITS / 2);
            area.draw(&PathElement::new(vec![point, nearest], line))?;
        }
        self.fill(area, block, name, size)
    }
}

/// Width of a name, or a little more.
fn width_of(name: &str, size: i32) -> i32 {
    (name.chars().count() as f64 * LETTER * f64::from(size)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_the_panel_and_on_nothing_else() {
        let panel = Block::new((0, 0), (units(400), units(300)));
        let mut labels = Labels::within(panel);
        let points: Vec<_> = (0..12).map(|i| (units(20 * i + 40), units(10 * i + 60))).collect();
        points.iter().for_each(|&point| labels.keep_clear(point, units(4)));
        let size = (units(90), units(13));
        let mut place = |&point: &(i32, i32)| {
            let found = labels.place(point, size).unwrap();
            labels.taken.push(found);
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
}
