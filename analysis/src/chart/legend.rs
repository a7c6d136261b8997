//! Legends: samples of lines, fills and marks, with the words for each.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::base::{Area, Drawn, units, write};
use super::hatch::Fill;
use super::mark::Mark;
use super::stroke::Stroke;

/// Height of a line in pixels.
const ROW: i32 = 20;
/// Place and width of a sample, in pixels.
const SAMPLE: (i32, i32) = (20, 50);
/// Distance between a sample and its words, in pixels.
const GAP: i32 = 12;
/// Room on the right of the words, in pixels.
const RIGHT: i32 = 14;
/// Width of a letter in pixels: more than the mean of the used letters.
const LETTER: f64 = 6.0;

/// A part of the picture that a legend explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    Line(Stroke),
    Region(Fill),
    Point(Mark),
    /// Nothing: the words are a remark.
    Nothing,
}

/// Samples with their words.
pub struct Legend {
    pub columns: usize,
    pub entries: Vec<(Sample, String)>,
}

impl Legend {
    /// Width of a column in pixels.
    fn column(&self, width: i32) -> i32 {
        width / self.columns as i32
    }

    /// The rows of a picture with this width in pixels: of each entry its sample and its lines of words.
    fn rows(&self, width: i32) -> Vec<Vec<(Sample, Vec<String>)>> {
        let room = self.column(width) - SAMPLE.0 - SAMPLE.1 - GAP - RIGHT;
        let letters = (f64::from(room) / LETTER) as usize;
        let lines = |words: &str| -> Vec<String> {
            textwrap::wrap(words, letters).into_iter().map(Into::into).collect()
        };
        let entry = |(sample, words): &(Sample, String)| (*sample, lines(words));
        self.entries.chunks(self.columns).map(|row| row.iter().map(entry).collect()).collect()
    }

    /// Its height in a picture with this width, both in pixels.
    pub(super) fn height(&self, width: i32) -> i32 {
        self.rows(width).iter().map(|row| ROW * lines(row)).sum()
    }

    pub(super) fn draw(&self, area: &Area<'_>, width: i32) -> Drawn<()> {
        let mut top = 0;
        for row in self.rows(width) {
            for (column, (sample, words)) in row.iter().enumerate() {
                let left = column as i32 * self.column(width) + SAMPLE.0;
                sample.draw(area, (units(left), units(top + ROW / 2)))?;
                for (line, words) in words.iter().enumerate() {
                    let place = (left + SAMPLE.1 + GAP, top + ROW * line as i32 + ROW / 2);
                    write(area, (units(place.0), units(place.1)), HPos::Left, words)?;
                }
            }
            top += ROW * lines(&row);
        }
        Ok(())
    }
}

/// Lines of the longest entry of a row.
fn lines(row: &[(Sample, Vec<String>)]) -> i32 {
    row.iter().map(|(_, words)| words.len() as i32).max().unwrap_or(0)
}

impl Sample {
    /// Its entry, which says so if the part is outside of the picture.
    pub fn entry(self, is_seen: bool, words: String) -> (Self, String) {
        match is_seen {
            true => (self, words),
            false => (Self::Nothing, format!("{words}, outside of the picture")),
        }
    }

    /// Draws it with the middle of its left side at a point.
    fn draw(self, area: &Area<'_>, (x, y): (i32, i32)) -> Drawn<()> {
        let right = x + units(SAMPLE.1);
        match self {
            Self::Line(stroke) => stroke.draw(area, &[(x, y), (right, y)]),
            Self::Region(fill) => {
                let (x, y) = (x..right, y - units(7)..y + units(7));
                fill.draw(area, &x, &y)?;
                let corners = [(x.start, y.start), (x.end, y.end)];
                area.draw(&Rectangle::new(corners, BLACK.stroke_width(super::base::UNITS)))
            }
            Self::Point(mark) => mark.draw(area, ((x + right) / 2, y)),
            Self::Nothing => Ok(()),
        }
    }
}
