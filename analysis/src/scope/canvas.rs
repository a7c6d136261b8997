//! A picture of characters: styled text, and curves of braille dots.

use std::fmt;
use std::ops::Range;

use anstyle::Style;

/// A line of text: its parts with their styles.
pub type Line = Vec<(String, Style)>;

/// Dots of a character: columns and rows.
pub const DOTS: (usize, usize) = (2, 4);
/// The first braille character, without dots, and the bits of its dots by row and column (Unicode, 2800).
const BRAILLE: u32 = 0x2800;
const BITS: [[u32; DOTS.0]; DOTS.1] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

#[derive(Debug)]
pub struct Area {
    /// Columns.
    pub x: Range<usize>,
    /// Rows, from the top.
    pub y: Range<usize>,
}

/// The characters of a terminal. Text outside of it is left out.
#[derive(Clone, Debug)]
pub struct Canvas {
    width: usize,
    cells: Vec<(char, Style)>,
}

impl Canvas {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, cells: vec![(' ', Style::new()); width * height] }
    }

    pub fn width(&self) -> usize {
        self.width
    }

    fn cell(&mut self, x: usize, y: usize) -> Option<&mut (char, Style)> {
        (x < self.width).then_some(())?;
        self.cells.get_mut(y * self.width + x)
    }

    /// Writes a text to the right of a place, and returns the column behind it.
    pub fn write(&mut self, (x, y): (usize, usize), text: &str, style: Style) -> usize {
        text.chars().fold(x, |x, letter| {
            if let Some(cell) = self.cell(x, y) {
                // A name may come from a board: a terminal would obey a control character.
                *cell = (if letter.is_control() { ' ' } else { letter }, style);
            }
            x + 1
        })
    }

    /// Writes lines from a row on, in place of the text there.
    pub fn lines(&mut self, first: usize, lines: &[Line]) {
        for (y, line) in (first..).zip(lines) {
            let write = |x, (text, style): &(String, Style)| self.write((x, y), text, *style);
            let end = line.iter().fold(0, write);
            self.write((end, y), &" ".repeat(self.width.saturating_sub(end)), Style::new());
        }
    }

    /// Draws a line through points, of which the ranges fill the area.
    pub fn curve(&mut self, area: &Area, points: &[(f64, f64)], x: &Range<f64>, y: &Range<f64>) {
        if area.x.is_empty() || area.y.is_empty() {
            return;
        }
        let (across, down) = (area.x.len() * DOTS.0 - 1, area.y.len() * DOTS.1 - 1);
        let part = |value: f64, range: &Range<f64>| {
            ((value - range.start) / (range.end - range.start)).clamp(0.0, 1.0)
        };
        let dot = |&(at, value): &(f64, f64)| {
            (part(at, x) * across as f64, (1.0 - part(value, y)) * down as f64)
        };
        let dots: Vec<_> = points.iter().map(dot).collect();
        for pair in dots.windows(2) {
            let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            let steps = dx.abs().max(dy.abs()).ceil().max(1.0);
            for step in 0..=steps as usize {
                let part = step as f64 / steps;
                self.dot(area, (pair[0].0 + part * dx, pair[0].1 + part * dy));
            }
        }
    }

    fn dot(&mut self, area: &Area, place: (f64, f64)) {
        let (x, y) = (place.0.round() as usize, place.1.round() as usize);
        let bit = BITS[y % DOTS.1][x % DOTS.0];
        if let Some(cell) = self.cell(area.x.start + x / DOTS.0, area.y.start + y / DOTS.1) {
            let before = (cell.0 as u32).checked_sub(BRAILLE).filter(|bits| *bits < 0x100);
            cell.0 = char::from_u32(BRAILLE + (before.unwrap_or(0) | bit)).unwrap_or(' ');
        }
    }

    /// Its rows with escape sequences; without colours on request, where bold and dim stay.
    pub fn rows(&self, has_colour: bool) -> impl Iterator<Item = String> {
        self.cells.chunks(self.width.max(1)).map(move |row| {
            let runs = row.chunk_by(|a, b| a.1 == b.1).map(|run| {
                let effects = Style::new().effects(run[0].1.get_effects());
                let style = if has_colour { run[0].1 } else { effects };
                let text: String = run.iter().map(|cell| cell.0).collect();
                format!("{style}{text}{style:#}")
            });
            runs.collect()
        })
    }
}

impl fmt::Display for Canvas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.cells.chunks(self.width.max(1)).try_for_each(|row| {
            writeln!(f, "{}", row.iter().map(|cell| cell.0).collect::<String>())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_fills_its_area_and_stays_in_it() {
        let mut canvas = Canvas::new(6, 4);
        let points = [(0.0, -1.0), (1.0, 1.0), (1.0, 9.0)];
        canvas.curve(&Area { x: 1..5, y: 1..3 }, &points, &(0.0..1.0), &(-1.0..1.0));
        assert_eq!(canvas.to_string(), "      \n   ⡠⠊ \n ⡠⠊   \n      \n");
    }
}
