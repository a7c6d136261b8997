//! Speed against accuracy: for each case and each error a panel with all methods, families
//! distinguished by mark and colour, and the Pareto front with the names of its methods.

use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::Axes;
use super::*;
use crate::studies::tradeoff::{Axis, Method, Tradeoff};

mod marks;

use super::labels::{Block, Labels};
use marks::Mark;

/// Width and height of a panel in pixels.
const PANEL: (u32, u32) = (520, 350);
/// Height of a line of the legend in pixels.
const ROW: i32 = 22;
/// Width of an entry of the legend in pixels.
const ENTRY: i32 = 240;
/// Room inside a panel around its points, as a part of a decade.
const ROOM: f64 = 0.35;
/// Size of the text in a panel.
const SMALL: i32 = units(13);

type Logarithmic<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// Largest number of readable columns of panels at the width of a page.
const COLUMNS: usize = 2;

/// The panels of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Panels {
    /// The cases.
    pub cases: Vec<String>,
    /// Indices of the errors.
    pub errors: Vec<usize>,
}

impl Panels {
    /// All panels of a table in one or more legible charts: one, or one for each error, with a word for its
    /// name.
    pub fn all(table: &Tradeoff) -> Vec<(Option<&'static str>, Self)> {
        let cases: Vec<_> = table.cases().into_iter().map(str::to_owned).collect();
        let errors = table.comparison.errors;
        if errors.len() <= COLUMNS {
            return vec![(None, Self { cases, errors: (0..errors.len()).collect() })];
        }
        let of = |error: usize| Self { cases: cases.clone(), errors: vec![error] };
        let word = |error: usize| Some(errors[error].column.names[0]);
        (0..errors.len()).map(|error| (word(error), of(error))).collect()
    }

    /// Columns and rows: a row for each case, or for two cases if there is only one error.
    fn columns(&self) -> usize {
        match self.errors.len() {
            1 => self.cases.len().clamp(1, COLUMNS),
            many => many,
        }
    }

    fn each(&self) -> impl Iterator<Item = (&str, usize)> {
        let of = |case| self.errors.iter().map(move |&error| (case, error));
        self.cases.iter().map(String::as_str).flat_map(of)
    }
}

/// Draws panels of a table.
///
/// # Errors
/// If no method has a cost and an error, or the drawing fails.
pub fn tradeoff(table: &Tradeoff, panels: &Panels) -> Result<Picture, ChartError> {
    let columns = panels.columns();
    let rows_of_panels = panels.each().count().div_ceil(columns);
    let costs = range(table, &table.comparison.cost, |method| method.cost());
    let Some(costs) = costs else { return Err(ChartError::TooFewPoints) };
    let width = (PANEL.0 * columns as u32).max(SIZE.0);
    let per_row = (width as i32 / ENTRY).max(1);
    // The families, and the explanation of a front.
    let rows = rows(table, per_row) + 1;
    let height = (PANEL.1 * rows_of_panels as u32) as i32;
    let size = (width, (TITLE_ROOM + height + ROW * rows + 10) as u32);
    draw_sized(size, |area| {
        let area = area.margin(units(TOP), 0, 0, 0).titled(table.comparison.title, text(TITLE))?;
        let (plots, below) = area.split_vertically(units(height));
        let plots = plots.split_evenly((rows_of_panels, columns));
        for (plot, (case, error)) in plots.iter().zip(panels.each()) {
            Panel { table, case, error }.paint(plot, costs.clone())?;
        }
        write_legend(&below, table, per_row)
    })
}

/// Decades that contain all values of a column; `None` if there is nothing to draw.
fn range(
    table: &Tradeoff,
    axis: &Axis,
    value: impl Fn(&Method) -> Option<f64>,
) -> Option<Range<f64>> {
    let values = table.methods.iter().filter_map(value).map(|value| value.max(axis.floor));
    let logs = values.map(f64::log10).filter(|log| log.is_finite());
    let (low, high) = logs
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), log| (low.min(log), high.max(log)));
    (low <= high).then(|| 10_f64.powf(low - ROOM)..10_f64.powf(high + ROOM))
}

struct Panel<'t> {
    table: &'t Tradeoff,
    case: &'t str,
    error: usize,
}

impl Panel<'_> {
    fn axis(&self) -> &Axis {
        &self.table.comparison.errors[self.error]
    }

    /// The methods with a place in the chart, and the numbers of their families.
    fn places(&self, top: f64) -> Vec<(usize, (f64, f64))> {
        let families = self.table.families();
        let place = |method: &Method| {
            let family = families.iter().position(|&family| family == method.family)?;
            Some((family, self.place(method, top)?))
        };
        self.table.of(self.case).filter_map(place).collect()
    }

    /// Position of a method; a failing method is at the worst edge.
    fn place(&self, method: &Method, top: f64) -> Option<(f64, f64)> {
        let (cost, error) = (method.cost()?, method.error(self.error)?);
        let cost = cost.max(self.table.comparison.cost.floor);
        let error = if error.is_finite() { error.max(self.axis().floor) } else { top };
        cost.is_finite().then_some((cost, error))
    }

    fn paint(&self, area: &Area<'_>, costs: Range<f64>) -> Drawn<()> {
        let (axis, cost) = (self.axis(), &self.table.comparison.cost);
        let errors = range(self.table, axis, |method| method.error(self.error));
        let mut errors = errors.unwrap_or(0.1..1.0);
        let fails = self.table.methods.iter().any(|m| m.error(self.error) == Some(f64::INFINITY));
        let top = errors.end;
        if fails {
            errors.end *= 10_f64.powf(2.0 * ROOM);
        }
        let mut chart = axes::chart(area)
            .margin_top(2 * MARGIN)
            .build_cartesian_2d(costs.log_scale(), errors.clone().log_scale())?;
        let names = Axes::named(cost.label, axis.label);
        Axes { most: (8, 10), size: SMALL, ..names }.draw(&mut chart)?;
        self.paint_methods(&mut chart, top)?;
        let middle = (area.dim_in_pixel().0 as i32 + Y_LABELS) / 2;
        let caption = anchored(HPos::Center, VPos::Center);
        area.draw(&Text::new(self.case.to_owned(), (middle, MARGIN), caption))
    }

    fn paint_methods(&self, chart: &mut Logarithmic<'_, '_>, top: f64) -> Drawn<()> {
        let area = chart.plotting_area();
        let (x, y) = area.get_base_pixel();
        let pixel = |place: &(f64, f64)| {
            let (px, py) = area.map_coordinate(place);
            (px - x, py - y)
        };
        let plain = area.strip_coord_spec();
        let (width, height) = plain.dim_in_pixel();
        let mut labels = Labels::within(Block::new((0, 0), (width as i32, height as i32)));
        let places = self.places(top);
        for family in 0..self.table.families().len() {
            let line = places.iter().filter(|place| place.0 == family).map(|p| pixel(&p.1));
            let thin = Mark::of(family).colour().mix(0.5).stroke_width(UNITS);
            plain.draw(&PathElement::new(line.collect::<Vec<_>>(), thin))?;
        }
        let front = self.table.front(self.case, self.error);
        let stairs = stairs(front.iter().filter_map(|m| self.place(m, top)).map(|p| pixel(&p)));
        dash::Dash::of(1).draw(&plain, &stairs, 1)?;
        stairs.windows(2).for_each(|step| labels.keep_clear_along(step[0], step[1]));
        for (family, place) in &places {
            Mark::of(*family).draw(&plain, pixel(place))?;
            labels.mark(pixel(place), Mark::SIZE);
        }
        let levels = [(self.axis().floor, self.axis().at_floor), (top, "fails")];
        for (level, word) in levels {
            if places.iter().any(|place| place.1.1 == level) {
                let y = pixel(&(1.0, level)).1;
                dash::Dash::of(2).draw(&plain, &[(0, y), (width as i32, y)], 1)?;
                labels.keep_clear_along((0, y), (width as i32, y));
                labels.write_beside(&plain, y, word, SMALL)?;
            }
        }
        for method in front {
            let Some(place) = self.place(method, top) else { continue };
            labels.write(&plain, pixel(&place), &method.name, SMALL)?;
        }
        Ok(())
    }
}

/// From the cheapest to the best: across to the cost of the next method, then down to its error.
fn stairs(front: impl Iterator<Item = (i32, i32)>) -> Vec<(i32, i32)> {
    let mut line: Vec<(i32, i32)> = Vec::new();
    for place in front {
        if let Some(&(_, before)) = line.last() {
            line.push((place.0, before));
        }
        line.push(place);
    }
    line
}

/// Rows of families in the legend.
fn rows(table: &Tradeoff, per_row: i32) -> i32 {
    (table.families().len() as i32 + per_row - 1) / per_row
}

fn write_legend(area: &Area<'_>, table: &Tradeoff, per_row: i32) -> Drawn<()> {
    let style = || anchored(HPos::Left, VPos::Center);
    let place = |index: usize| {
        let (row, column) = (index as i32 / per_row, index as i32 % per_row);
        (units(30 + column * ENTRY), units(ROW * row + ROW / 2))
    };
    let families = table.families();
    for (index, family) in families.iter().enumerate() {
        let (x, y) = place(index);
        Mark::of(index).draw(area, (x, y))?;
        area.draw(&Text::new((*family).to_owned(), (x + units(14), y), style()))?;
    }
    let y = units(ROW * rows(table, per_row) + ROW / 2);
    dash::Dash::of(1).draw(area, &[(units(20), y), (units(60), y)], 1)?;
    let words = "front: no other method of the table is both cheaper and better";
    area.draw(&Text::new(words, (units(70), y), style()))
}
