//! The surface that all charts are drawn on: its units and its text.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Units of the drawing in a pixel. Coordinates are whole numbers, and a curve on whole pixels
/// would be jagged.
pub const UNITS: u32 = 8;
/// Font of all text; every viewer has one by this name.
pub const FONT: &str = "sans-serif";
/// Size of all text except titles.
pub const LABEL: i32 = units(14);

/// Pixels in units of the drawing.
pub const fn units(pixels: i32) -> i32 {
    pixels * UNITS as i32
}

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn<T> = Result<T, DrawingAreaErrorKind<std::io::Error>>;

pub fn text(size: i32) -> TextStyle<'static> {
    TextStyle::from((FONT, size)).color(&BLACK)
}

/// Writes words; the point is the middle of their left or right side, or of all of them.
pub fn write(area: &Area<'_>, point: (i32, i32), side: HPos, words: &str) -> Drawn<()> {
    let style = text(LABEL).pos(Pos::new(side, VPos::Center));
    area.draw(&Text::new(words.to_owned(), point, style))
}
