//! Names beside points, none of them on another or on a point.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::chart::{Area, Drawn, FONT, UNITS, units};

/// Width of a letter over the size of its font: more than the mean of the letters in use, so that
/// a name is never longer than its block.
const LETTER: f64 = 0.6;
/// Between a point and its name.
const GAP: i32 = units(7);
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

    /// The nearest place to a point where a name of that size fits, and takes it; `None` where the
    /// panel is full.
    fn place(&mut self, (x, y): (i32, i32), (width, height): (i32, i32)) -> Option<Block> {
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
        let free = |block: &Block| {
            self.panel.holds(block) && !self.taken.iter().any(|taken| taken.meets(block))
        };
        let found = around.map(block).find(free)?;
        self.taken.push(found);
        Some(found)
    }

    /// Writes a name beside a point, with a thin line to it where it had to go far.
    pub fn write(
        &mut self,
        area: &Area<'_>,
        point: (i32, i32),
        name: &str,
        size: i32,
    ) -> Drawn<()> {
        let width = (name.chars().count() as f64 * LETTER * f64::from(size)) as i32;
        let Some(block) = self.place(point, (width, size)) else { return Ok(()) };
        let nearest =
            (point.0.clamp(block.left, block.right), point.1.clamp(block.top, block.bottom));
        let far = (nearest.0 - point.0).abs().max((nearest.1 - point.1).abs()) > 2 * GAP;
        if far {
            let line = BLACK.mix(0.4).stroke_width(UNITS / 2);
            area.draw(&PathElement::new(vec![point, nearest], line))?;
        }
        let middle = ((block.left + block.right) / 2, (block.top + block.bottom) / 2);
        let style = TextStyle::from((FONT, size)).color(&BLACK);
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        area.draw(&Text::new(name.to_owned(), middle, style))
    }
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
        let placed: Vec<_> = points.iter().map(|&p| labels.place(p, size).unwrap()).collect();
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
