//! Marks of points; those of families differ in form and colour.

use plotters::prelude::*;

use super::base::{Area, Drawn, UNITS, units};
use super::palette::{FAINT, FAMILIES};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    form: Form,
    /// Half of its size, in pixels.
    half: i32,
    /// Width of its lines, in pixels.
    width: u32,
    ink: RGBColor,
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

/// In the order of the families.
const FORMS: [Form; FAMILIES.len()] = [
    Form::Disk,
    Form::Square,
    Form::Triangle,
    Form::Diamond,
    Form::Cross,
    Form::Plus,
    Form::Ring,
    Form::Frame,
];

impl Mark {
    /// The scene itself.
    pub const SCENE: Self = Self { form: Form::Cross, half: 7, width: 2, ink: BLACK };
    /// A point of a measurement or of a curve.
    pub const DOT: Self = Self { form: Form::Disk, half: 3, width: 0, ink: BLACK };
    /// A sample among many.
    pub const FAINT: Self = Self { form: Form::Disk, half: 2, width: 0, ink: FAINT };
    /// A point at which something goes wrong.
    pub const CROSS: Self = Self { form: Form::Cross, half: 4, width: 1, ink: BLACK };
    pub const RING: Self = Self { form: Form::Ring, half: 5, width: 2, ink: BLACK };
    pub const FRAME: Self = Self { form: Form::Frame, half: 6, width: 2, ink: BLACK };

    /// The mark of the family with this number; the marks repeat.
    pub const fn of(family: usize) -> Self {
        let family = family % FAMILIES.len();
        Self { form: FORMS[family], half: 4, width: 2, ink: FAMILIES[family] }
    }

    pub const fn ink(self) -> RGBColor {
        self.ink
    }

    /// Half its size in units of the drawing.
    pub const fn reach(self) -> i32 {
        units(self.half)
    }

    /// Draws it around a point in units of the drawing.
    pub(super) fn draw(self, area: &Area<'_>, (x, y): (i32, i32)) -> Drawn<()> {
        let s = self.reach();
        let (d, line) = (s * 5 / 4, self.ink.stroke_width(self.width * UNITS));
        let stroke = |from: (i32, i32), to: (i32, i32), style: ShapeStyle| {
            area.draw(&PathElement::new([(x + from.0, y + from.1), (x + to.0, y + to.1)], style))
        };
        let polygon = |corners: &[(i32, i32)]| {
            let points: Vec<_> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
            area.draw(&Polygon::new(points, self.ink.filled()))
        };
        let square = |half: i32, ink: RGBColor| {
            let corners = [(x - half, y - half), (x + half, y + half)];
            area.draw(&Rectangle::new(corners, ink.filled()))
        };
        match self.form {
            Form::Disk => area.draw(&Circle::new((x, y), s, self.ink.filled())),
            Form::Ring => {
                area.draw(&Circle::new((x, y), s, WHITE.filled()))?;
                area.draw(&Circle::new((x, y), s, line))
            }
            Form::Square => square(s, self.ink),
            Form::Frame => {
                square(s, self.ink)?;
                square(s - units(self.width as i32), WHITE)
            }
            Form::Triangle => polygon(&[(0, -d), (d, s), (-d, s)]),
            Form::Diamond => polygon(&[(0, -d), (d, 0), (0, d), (-d, 0)]),
            Form::Plus => {
                stroke((-d, 0), (d, 0), line)?;
                stroke((0, -d), (0, d), line)
            }
            Form::Cross => {
                // A wide one has a white border, to be visible on lines and in dark regions.
                let border = WHITE.stroke_width((self.width + 3) * UNITS);
                for style in
                    [Some(border).filter(|_| self.width > 1), Some(line)].into_iter().flatten()
                {
                    stroke((-s, -s), (s, s), style)?;
                    stroke((-s, s), (s, -s), style)?;
                }
                Ok(())
            }
        }
    }
}
