//! A picture as a whole: title, panels below each other, legends.

use plotters::prelude::*;

use super::base::{Area, Drawn, UNITS, text, units};
use super::error::ChartError;
use super::legend::{Legend, Sample};
use super::picture::Picture;
use super::strokes::join_strokes;
use crate::quantity::shortened;

/// Usual width and height of a picture without its title and legends, in pixels.
pub const WIDTH: i32 = 820;
pub const HEIGHT: i32 = 524;

const TITLE: i32 = units(19);
/// Width of a letter of a title in pixels: more than that of most letters.
const LETTER: i32 = 11;
/// Room above a title, and height of a title with this room, in pixels.
const TOP: i32 = 10;
const TITLE_ROOM: i32 = TOP + 26;
/// Room above the legends and below, in pixels.
const APART: i32 = 8;

pub struct Page<'p> {
    title: &'p str,
    /// In pixels.
    width: i32,
    heights: &'p [i32],
    legends: Vec<Legend>,
}

impl<'p> Page<'p> {
    /// A page of the usual width; `heights` are those of the parts that are painted, in pixels.
    pub fn new(title: &'p str, heights: &'p [i32]) -> Self {
        Self { title, width: WIDTH, heights, legends: Vec::new() }
    }

    /// With another width in pixels.
    pub fn wide(self, width: i32) -> Self {
        Self { width, ..self }
    }

    /// Below it a legend more: entries in columns, row by row.
    pub fn legend<W: Into<String>>(
        mut self,
        columns: usize,
        entries: impl IntoIterator<Item = (Sample, W)>,
    ) -> Self {
        let entries = entries.into_iter().map(|(sample, words)| (sample, words.into()));
        self.legends.push(Legend { columns, entries: entries.collect() });
        self
    }

    /// Draws it; `paint` gets an area for each height.
    pub(super) fn draw(
        &self,
        paint: impl FnOnce(&[Area<'_>]) -> Drawn<()>,
    ) -> Result<Picture, ChartError> {
        let legends = self.legends.iter().map(|legend| legend.height(self.width));
        let parts: Vec<i32> = self.heights.iter().copied().chain([APART]).chain(legends).collect();
        let height = TITLE_ROOM + parts.iter().sum::<i32>() + APART;
        let mut svg = String::new();
        let size = [self.width, height].map(|pixels| pixels.cast_unsigned());
        let drawn = {
            let area = SVGBackend::with_string(&mut svg, (size[0] * UNITS, size[1] * UNITS));
            let area = area.into_drawing_area();
            self.paint(&area, &parts, paint).and_then(|()| area.present())
        };
        drawn.map_err(|error| ChartError::Drawing(error.to_string()))?;
        // The drawing keeps its units; only its size on the page is in pixels.
        let drawing =
            format!("width=\"{}\" height=\"{}\" viewBox", size[0] * UNITS, size[1] * UNITS);
        let page = format!("width=\"{}\" height=\"{}\" viewBox", size[0], size[1]);
        Ok(Picture { svg: join_strokes(&svg.replacen(&drawing, &page, 1)) })
    }

    fn paint(
        &self,
        area: &Area<'_>,
        parts: &[i32],
        paint: impl FnOnce(&[Area<'_>]) -> Drawn<()>,
    ) -> Drawn<()> {
        area.fill(&WHITE)?;
        let title = shortened(self.title, (self.width / LETTER) as usize);
        let mut rest = area.margin(units(TOP), 0, 0, 0).titled(&title, text(TITLE))?;
        let mut areas = Vec::new();
        for part in parts {
            let (area, below) = rest.split_vertically(units(*part));
            areas.push(area);
            rest = below;
        }
        let (panels, legends) = areas.split_at(self.heights.len());
        paint(panels)?;
        // The first is the room above the legends.
        let legends = self.legends.iter().zip(&legends[1..]);
        legends.into_iter().try_for_each(|(legend, area)| legend.draw(area, self.width))
    }
}
