//! A picture of characters: styled text, and curves of braille dots.

use std::fmt;
use std::ops::Range;

use anstyle::Style;

/// Dots of a character: columns and rows.
pub const DOTS: (usize, usize) = (2, 4);
/// The first braille character, without dots, and the bits of its dots by row and column (Unicode, 2800).
const BRAILLE: u32 = 0x2800;
const BITS: [[u32; DOTS.0]; DOTS.1] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// A rectangle of characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Area {
    /// Columns.
    pub x: Range<usize>,
    /// Rows, from the top.
    pub y: Range<usize>,
}

impl Area {
    /// The same without its border.
    pub fn inside(&self) -> Self {
        let inner = |range: &Range<usize>| range.start + 1..range.end.saturating_sub(1);
        Self { x: inner(&self.x), y: inner(&self.y) }
    }
}

/// The characters of a terminal. Text outside of it is left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Canvas {
    width: usize,
    cells: Vec<(char, Style)>,
}

impl Canvas {
    /// An empty canvas.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, cells: vec![(' ', Style::new()); width * height] }
    }

    fn cell(&mut self, (x, y): (usize, usize)) -> Option<&mut (char, Style)> {
        (x < self.width).then_some(())?;
        self.cells.get_mut(y * self.width + x)
    }

    /// Writes a text to the right of a place, and returns the column behind it.
    pub fn write(&mut self, (x, y): (usize, usize), text: &str, style: Style) -> usize {
        text.chars().fold(x, |x, letter| {
            if let Some(cell) = self.cell((x, y)) {
                *cell = (letter, style);
            }
            x + 1
        })
    }

    /// Draws a border with a title.
    pub fn border(&mut self, area: &Area, title: &str) {
        let Area { x, y } = area;
        if x.len() < 2 || y.len() < 2 {
            return;
        }
        let line = "─".repeat(x.len() - 2);
        self.write((x.start, y.start), &format!("┌{line}┐"), Style::new());
        self.write((x.start, y.end - 1), &format!("└{line}┘"), Style::new());
        for row in y.start + 1..y.end - 1 {
            self.write((x.start, row), "│", Style::new());
            self.write((x.end - 1, row), "│", Style::new());
        }
        let title: String = title.chars().take(x.len() - 2).collect();
        self.write((x.start + 1, y.start), &title, Style::new());
    }

    /// Draws a line through points, of which the ranges fill the area.
    pub fn curve(&mut self, area: &Area, points: &[(f64, f64)], x: &Range<f64>, y: &Range<f64>) {
        let last = |cells: &Range<usize>, dots: usize| (dots * cells.len()) as f64 - 1.0;
        let (across, down) = (last(&area.x, DOTS.0), last(&area.y, DOTS.1));
        let dot = |&(at, value): &(f64, f64)| {
            let part = |value: f64, range: &Range<f64>| {
                ((value - range.start) / (range.end - range.start)).clamp(0.0, 1.0)
            };
            (part(at, x) * across, (1.0 - part(value, y)) * down)
        };
        if across < 0.0 || down < 0.0 {
            return;
        }
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
        let Some(cell) = self.cell((area.x.start + x / DOTS.0, area.y.start + y / DOTS.1)) else {
            return;
        };
        let before = (cell.0 as u32).checked_sub(BRAILLE).filter(|bits| *bits < 0x100);
        cell.0 = char::from_u32(BRAILLE + (before.unwrap_or(0) | bit)).unwrap_or(' ');
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
            runs.collect::<String>()
        })
    }
}

/// Its text.
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
    fn a_curve_fills_its_area_and_stays_in_its_border() {
        let mut canvas = Canvas::new(6, 4);
        let area = Area { x: 0..6, y: 0..4 };
        canvas.border(&area, "long title");
        let points = [(0.0, -1.0), (1.0, 1.0), (1.0, 9.0)];
        canvas.curve(&area.inside(), &points, &(0.0..1.0), &(-1.0..1.0));
        let text = canvas.to_string();
        let is_curve = |letter: &char| ('\u{2801}'..='\u{28ff}').contains(letter);
        assert_eq!(text.chars().filter(is_curve).count(), 4, "{text}");
        let frame: String = text.chars().map(|c| if is_curve(&c) { '.' } else { c }).collect();
        assert_eq!(frame, "┌long┐\n│  ..│\n│..  │\n└────┘\n");
    }
}
