//! Marks of families: they differ in form, and in colours that are distinct for colour-blind readers.

use plotters::prelude::*;

use crate::chart::{Area, Drawn, UNITS, units};

/// The mark of a family of methods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    form: Form,
    colour: RGBColor,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Disk,
    Ring,
    Square,
    Frame,
    Triangle,
    Diamond,
    Cross,
    Plus,
}

/// In the order of the families. Colours of Okabe and Ito, without yellow, which is hard to see on white.
const MARKS: [(Form, RGBColor); 8] = [
    (Form::Disk, RGBColor(0, 0, 0)),
    (Form::Square, RGBColor(0, 114, 178)),
    (Form::Triangle, RGBColor(213, 94, 0)),
    (Form::Diamond, RGBColor(0, 158, 115)),
    (Form::Cross, RGBColor(204, 121, 167)),
    (Form::Plus, RGBColor(230, 159, 0)),
    (Form::Ring, RGBColor(86, 180, 233)),
    (Form::Frame, RGBColor(110, 110, 110)),
];

impl Mark {
    /// Half of a mark's size, in units of the drawing.
    pub const SIZE: i32 = units(4);

    /// The mark of the family with this number; the marks repeat.
    pub fn of(family: usize) -> Self {
        let (form, colour) = MARKS[family % MARKS.len()];
        Self { form, colour }
    }

    /// Its colour.
    pub fn colour(self) -> RGBColor {
        self.colour
    }

    /// Draws it around a point in units of the drawing.
    pub fn draw(self, area: &Area<'_>, (x, y): (i32, i32)) -> Drawn<()> {
        let (s, line) = (Self::SIZE, self.colour.stroke_width(2 * UNITS));
        let stroke = |from: (i32, i32), to: (i32, i32)| {
            let points = vec![(x + from.0, y + from.1), (x + to.0, y + to.1)];
            area.draw(&PathElement::new(points, line))
        };
        let polygon = |corners: &[(i32, i32)]| {
            let points: Vec<_> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
            area.draw(&Polygon::new(points, self.colour.filled()))
        };
        let d = s * 5 / 4;
        match self.form {
            Form::Disk => area.draw(&Circle::new((x, y), s, self.colour.filled())),
            Form::Ring => area.draw(&Circle::new((x, y), s, line)),
            Form::Square => polygon(&[(-s, -s), (s, -s), (s, s), (-s, s)]),
            Form::Frame => [(-s, -s), (s, -s), (s, s), (-s, s), (-s, -s)]
                .windows(2)
                .try_for_each(|side| stroke(side[0], side[1])),
            Form::Triangle => polygon(&[(0, -d), (d, s), (-d, s)]),
            Form::Diamond => polygon(&[(0, -d), (d, 0), (0, d), (-d, 0)]),
            Form::Cross => stroke((-s, -s), (s, s)).and_then(|()| stroke((-s, s), (s, -s))),
            Form::Plus => stroke((-d, 0), (d, 0)).and_then(|()| stroke((0, -d), (0, d))),
        }
    }
}
