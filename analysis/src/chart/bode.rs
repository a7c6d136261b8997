//! The open loop over frequency: gain above phase, with the margins to -1 marked.

use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::dash::Dash;
use super::plot_area::{Frame, whole};
use super::*;
use crate::open_loop::{Margin, OpenLoop};
use crate::quantity::{shortened, significant};

/// Height of a line of the legend in pixels.
const ROW: i32 = 20;
/// Heights of the panels in pixels.
const PANELS: [i32; 2] = [290, 270];
/// Longest name in the legend, in letters.
const LONGEST_NAME: usize = 40;
/// Decades above and below a gain of 1 by default.
const DECADES: f64 = 3.0;
/// A margin's line.
const MARK: Dash = Dash::new(&[3, 3]);

type Gains<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;
type Phases<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, RangedCoordf64>>;

/// Draws the open loops of named scenes; `wanted` are the ranges of frequency in Hz and of gain, above 0.
///
/// # Errors
/// If there is none, or the drawing fails.
pub fn bode(
    title: &str,
    loops: &[(String, OpenLoop)],
    wanted: &Window,
) -> Result<Picture, ChartError> {
    let points = || loops.iter().flat_map(|(_, found)| &found.points);
    let all = span(points().map(|point| point.hertz));
    if all.start >= all.end || all.start <= 0.0 {
        return Err(ChartError::TooFewPoints);
    }
    meets("horizontal", wanted.x.as_ref(), &all)?;
    meets("vertical", wanted.y.as_ref(), &span(points().map(|point| point.gain)))?;
    let x = wanted.x.clone().unwrap_or_else(|| interesting(loops, &all));
    // The last point is at half the sample rate, where the phase falls fastest.
    let seen = || points().filter(|point| (x.start..=x.end).contains(&point.hertz));
    let far = 10_f64.powf(DECADES);
    let gains = seen().map(|point| point.gain.clamp(1.0 / far, far));
    let gains = span(gains.chain([1.0]));
    let y = wanted.y.clone().unwrap_or(gains.start / 2.0..gains.end * 2.0);
    let words = words(loops);
    let legend = ROW * words.len() as i32 + 10;
    let height = TITLE_ROOM + PANELS.iter().sum::<i32>() + legend;
    draw_sized((SIZE.0, height as u32), |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(&shortened(title, 72), text(TITLE))?;
        let (upper, area) = area.split_vertically(units(PANELS[0]));
        let (lower, below) = area.split_vertically(units(PANELS[1]));
        paint_gains(&upper, loops, &x, &y)?;
        let phases = padded(span(seen().map(|point| point.phase).chain([-180.0])), 0.06);
        paint_phases(&lower, loops, &x, &phases)?;
        write_legend(&below, &words)
    })
}

/// The frequencies around the margins, a decade to each side and more.
fn interesting(loops: &[(String, OpenLoop)], all: &Range<f64>) -> Range<f64> {
    let margins = loops.iter().flat_map(|(_, found)| marked(found)).map(|margin| margin.hertz);
    let lowest = margins.fold(all.end, f64::min);
    (lowest / 30.0).clamp(all.start, all.end / 100.0)..all.end
}

/// The margins with marks: those nearest to -1.
fn marked(found: &OpenLoop) -> impl Iterator<Item = Margin> {
    let all = [found.gain_margin(), found.gain_reduction(), found.phase_margin()];
    all.into_iter().flatten()
}

fn paint_gains(
    area: &Area<'_>,
    loops: &[(String, OpenLoop)],
    x: &Range<f64>,
    y: &Range<f64>,
) -> Drawn<()> {
    let mut chart: Gains<'_, '_> = axes::chart(area)
        .margin_right(MARGIN_RIGHT)
        .margin_bottom(units(2))
        .x_label_area_size(units(24))
        .build_cartesian_2d(x.clone().log_scale(), y.clone().log_scale())?;
    Axes { most: (12, 8), ..Axes::named(None, "gain (1)") }.draw(&mut chart)?;
    let plot = chart.plotting_area();
    let panel = plot.strip_coord_spec();
    let sheet = Logarithmic::of(&panel, x, |gain| (gain / y.start).ln() / (y.end / y.start).ln());
    sheet.level(1.0)?;
    for (index, (_, found)) in loops.iter().enumerate() {
        let curve = found.points.iter().map(|point| (point.hertz, point.gain));
        sheet.curve(Dash::of(index), curve)?;
        for margin in [found.gain_margin(), found.gain_reduction()].into_iter().flatten() {
            sheet.mark(margin.hertz, [1.0, 1.0 / margin.value])?;
        }
    }
    Ok(())
}

fn paint_phases(
    area: &Area<'_>,
    loops: &[(String, OpenLoop)],
    x: &Range<f64>,
    y: &Range<f64>,
) -> Drawn<()> {
    let mut chart: Phases<'_, '_> = axes::chart(area)
        .margin_right(MARGIN_RIGHT)
        .build_cartesian_2d(x.clone().log_scale(), y.clone())?;
    let names = Axes::named("frequency (Hz)", "phase (degrees)");
    Axes { most: (12, 8), ..names }.draw(&mut chart)?;
    let plot = chart.plotting_area();
    let panel = plot.strip_coord_spec();
    let sheet = Logarithmic::of(&panel, x, |phase| (phase - y.start) / (y.end - y.start));
    sheet.level(-180.0)?;
    for (index, (_, found)) in loops.iter().enumerate() {
        let curve = found.points.iter().map(|point| (point.hertz, point.phase));
        sheet.curve(Dash::of(index), curve)?;
        if let Some(margin) = found.phase_margin() {
            let phase = phase_at(found, margin.hertz);
            sheet.mark(margin.hertz, [phase, phase - margin.value])?;
        }
    }
    Ok(())
}

/// The phase next to a frequency.
fn phase_at(found: &OpenLoop, hertz: f64) -> f64 {
    let next = found.points.partition_point(|point| point.hertz < hertz);
    found.points.get(next).map_or(-180.0, |point| point.phase)
}

/// A panel over logarithmic frequency.
struct Logarithmic<'a, 'b, F> {
    area: &'a Area<'b>,
    x: &'a Range<f64>,
    up: F,
    frame: Frame,
}

impl<'a, 'b, F: Fn(f64) -> f64> Logarithmic<'a, 'b, F> {
    /// `up` maps a value to a fraction of the height.
    fn of(area: &'a Area<'b>, x: &'a Range<f64>, up: F) -> Self {
        let (width, height) = area.dim_in_pixel();
        let (right, bottom) = (f64::from(width), f64::from(height));
        Self { area, x, up, frame: Frame { left: 0.0, top: 0.0, right, bottom } }
    }

    fn place(&self, (hertz, value): (f64, f64)) -> (f64, f64) {
        let across = (hertz / self.x.start).ln() / (self.x.end / self.x.start).ln();
        (across * self.frame.right, (1.0 - (self.up)(value)) * self.frame.bottom)
    }

    fn curve(&self, dash: Dash, points: impl Iterator<Item = (f64, f64)>) -> Drawn<()> {
        let places: Vec<_> = points.map(|point| self.place(point)).collect();
        for part in Frame::clip(&places, |_| self.frame) {
            dash.draw(self.area, &part.iter().map(whole).collect::<Vec<_>>(), 2)?;
        }
        Ok(())
    }

    /// A level line across the panel.
    fn level(&self, value: f64) -> Drawn<()> {
        let y = self.place((self.x.start, value)).1;
        if y < self.frame.top || y > self.frame.bottom {
            return Ok(());
        }
        let ends = [(0.0, y), (self.frame.right, y)].map(|place| whole(&place));
        self.area.draw(&PathElement::new(ends.to_vec(), FAINT.stroke_width(UNITS)))
    }

    /// An upright line between two values, with a dot at its second end.
    fn mark(&self, hertz: f64, values: [f64; 2]) -> Drawn<()> {
        let ends = values.map(|value| self.frame.nearest(self.place((hertz, value))));
        if hertz < self.x.start || hertz > self.x.end {
            return Ok(());
        }
        MARK.draw(self.area, &ends.map(|end| whole(&end)), 2)?;
        for end in ends {
            self.area.draw(&Circle::new(whole(&end), units(3), BLACK.filled()))?;
        }
        Ok(())
    }
}

/// The margins of the loops, one line for each loop.
pub fn words(loops: &[(String, OpenLoop)]) -> Vec<String> {
    let of = |(name, found): &(String, OpenLoop)| {
        let at = |margin: Margin| format!("at {} Hz", significant(margin.hertz, 3));
        let decibels = |factor: f64| significant(20.0 * factor.log10(), 3);
        let factor = |margin: Margin| {
            let (value, db) = (significant(margin.value, 4), decibels(margin.value));
            format!("gain margin {value} ({db} dB) {}", at(margin))
        };
        let gains = [found.gain_margin(), found.gain_reduction()];
        let mut words: Vec<_> = gains.into_iter().flatten().map(factor).collect();
        if words.is_empty() {
            words.push("no gain margin: the phase is never -180 degrees".to_owned());
        }
        words.push(found.phase_margin().map_or_else(
            || "no phase margin: the gain is never 1".to_owned(),
            |margin| {
                format!("phase margin {} degrees {}", significant(margin.value, 3), at(margin))
            },
        ));
        let fate = if found.is_stable { "stable" } else { "UNSTABLE" };
        format!("{}: {fate}; {}", shortened(name, LONGEST_NAME), words.join("; "))
    };
    loops.iter().map(of).collect()
}

fn write_legend(area: &Area<'_>, words: &[String]) -> Drawn<()> {
    for (row, line) in words.iter().enumerate() {
        let middle = units(ROW * row as i32 + ROW / 2);
        Dash::of(row).draw(area, &[(units(20), middle), (units(60), middle)], 2)?;
        let style = anchored(HPos::Left, VPos::Center);
        area.draw(&Text::new(line.clone(), (units(70), middle), style))?;
    }
    Ok(())
}

/// The numbers of the chart.
pub fn data(loops: Vec<(String, OpenLoop)>) -> Data {
    let rows = loops.into_iter().flat_map(|(name, found)| {
        found.points.into_iter().map(move |point| {
            vec![(&*name).into(), point.hertz.into(), point.gain.into(), point.phase.into()]
        })
    });
    Data::new(&["scene", "frequency (Hz)", "gain (1)", "phase (degrees)"], rows)
}
