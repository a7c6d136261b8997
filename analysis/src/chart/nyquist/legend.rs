//! The legend below a Nyquist plot.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::{NyquistScene, lines};
use crate::chart::dash::Dash;
use crate::chart::{Area, Drawn, FAINT, UNITS, anchored, units};
use crate::nyquist::words;
use crate::quantity::shortened;

/// Height of a line of the legend in pixels.
const ROW: i32 = 19;
/// Longest name in the legend, in letters.
const LONGEST_NAME: usize = 48;

/// An entry below the plot: lines of text with the patterns that they explain.
struct Entry {
    /// Pattern and ink of the explained line.
    sample: Option<(Dash, RGBColor, u32)>,
    words: Vec<String>,
}

/// Height of the legend in units of the drawing.
pub(super) fn height(scenes: &[NyquistScene]) -> i32 {
    let rows: usize = legend(scenes).iter().map(|entry| entry.words.len()).sum();
    units(ROW * rows as i32 + 10)
}

fn legend(scenes: &[NyquistScene]) -> Vec<Entry> {
    let of = |(index, (scene, lines)): (usize, (&NyquistScene, Vec<super::Line<'_>>))| {
        let name = match scenes.len() {
            1 => String::new(),
            _ => format!("{}: {}: ", index + 1, shortened(&scene.name, LONGEST_NAME)),
        };
        let curves = lines.into_iter().map(|line| {
            let judged = line.curve.role.is_judged();
            let ink = if judged { BLACK } else { FAINT };
            let words = words::curve(&name, scene, line.curve, scenes.len() == 1);
            Entry { sample: Some((line.dash, ink, 2)), words }
        });
        let bound = bound(&name, scene);
        curves.chain(bound).collect::<Vec<_>>()
    };
    let mut entries: Vec<_> = scenes.iter().zip(lines(scenes)).enumerate().flat_map(of).collect();
    if scenes.len() == 1
        && let Some(first) = entries.first_mut()
    {
        first.words.insert(0, words::HALVES.to_owned());
    }
    entries
}

/// The line that is judged in place of a curve.
fn bound(name: &str, scene: &NyquistScene) -> Option<Entry> {
    let sample = scene.bound.map(|_| (Dash::of(0), BLACK, 3));
    words::bound(name, scene).map(|words| Entry { sample, words })
}

pub(super) fn write(area: &Area<'_>, scenes: &[NyquistScene]) -> Drawn<()> {
    let mut row = 0;
    for Entry { sample, words } in legend(scenes) {
        for (index, line) in words.into_iter().enumerate() {
            let middle = units(ROW * row + ROW / 2);
            if let Some((dash, ink, width)) = sample.filter(|_| index == 0) {
                let ends = [(units(20), middle), (units(76), middle)];
                dash.draw_styled(area, &ends, ink.stroke_width(width * UNITS))?;
            }
            let style = anchored(HPos::Left, VPos::Center);
            area.draw(&Text::new(line, (units(88), middle), style))?;
            row += 1;
        }
    }
    Ok(())
}
