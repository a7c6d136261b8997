//! Speed against accuracy: for each case a panel with all methods, families
//! distinguished by mark and colour, and the Pareto front with the names of its methods.

use super::labels::{Block, Labels};
use super::*;
use crate::studies::tradeoff::{Axis as Figure, Method, Tradeoff};

/// Width and height of a panel in pixels.
const PANEL: (i32, i32) = (520, 350);
/// Width of an entry of the legend in pixels.
const ENTRY: i32 = 260;
/// Room inside a panel around its points, as a part of a decade.
const ROOM: f64 = 0.35;
/// The line of a Pareto front, and of the levels without a seen error and of failures.
const FRONT: Stroke = Stroke::dashed(&[11, 5], 1);
const LEVEL: Stroke = Stroke::dashed(&[2, 4], 1);

/// Largest number of readable columns of panels at the width of a page.
const COLUMNS: usize = 2;

/// Draws a panel for each case of a table, by the error with this index.
pub fn tradeoff(table: &Tradeoff, error: usize) -> Result<Picture, ChartError> {
    let cases = table.cases();
    let columns = cases.len().clamp(1, COLUMNS);
    let rows = cases.len().div_ceil(columns);
    let cost = &table.comparison.cost;
    let costs = range(table, cost, Method::cost).ok_or(ChartError::TooFewPoints)?;
    let width = (PANEL.0 * columns as i32).max(WIDTH);
    let families = table.families().into_iter().enumerate();
    let families = families.map(|(index, name)| (Sample::Point(Mark::of(index)), name));
    let front = "front: no other method of the table is both cheaper and better";
    let heights = [PANEL.1 * rows as i32];
    let page = Page::new(table.comparison.title, &heights).wide(width);
    let page = page.legend((width / ENTRY) as usize, families);
    page.legend(1, [(Sample::Line(FRONT), front)]).draw(|areas| {
        let areas = areas[0].split_evenly((rows, columns));
        areas
            .iter()
            .zip(cases)
            .try_for_each(|(area, case)| Methods { table, case, error }.paint(area, costs.clone()))
    })
}

/// Decades that contain all values of a column; `None` if there is nothing to draw.
fn range(
    table: &Tradeoff,
    figure: &Figure,
    value: impl Fn(&Method) -> Option<f64>,
) -> Option<Range<f64>> {
    let values = table.methods.iter().filter_map(value).map(|value| value.max(figure.floor));
    let logs: Vec<_> = values.map(f64::log10).filter(|log| log.is_finite()).collect();
    let Range { start, end } = span(logs.iter().copied());
    (!logs.is_empty()).then(|| 10_f64.powf(start - ROOM)..10_f64.powf(end + ROOM))
}

/// The methods of a case by one error.
struct Methods<'t> {
    table: &'t Tradeoff,
    case: &'t str,
    error: usize,
}

impl Methods<'_> {
    fn figure(&self) -> &Figure {
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

    /// Cost and error of a method; a failing method is at the worst edge.
    fn place(&self, method: &Method, top: f64) -> Option<(f64, f64)> {
        let (cost, error) = (method.cost()?, method.error(self.error)?);
        let cost = cost.max(self.table.comparison.cost.floor);
        let error = if error.is_finite() { error.max(self.figure().floor) } else { top };
        cost.is_finite().then_some((cost, error))
    }

    fn paint(&self, area: &Area<'_>, costs: Range<f64>) -> Drawn<()> {
        let (figure, cost) = (self.figure(), &self.table.comparison.cost);
        let errors = range(self.table, figure, |method| method.error(self.error));
        let mut errors = errors.unwrap_or(0.1..1.0);
        let fails = self.table.methods.iter().any(|m| m.error(self.error) == Some(f64::INFINITY));
        let top = errors.end;
        if fails {
            errors.end *= 10_f64.powf(2.0 * ROOM);
        }
        let (x, y) =
            (Axis::logarithmic(costs, cost.label), Axis::logarithmic(errors, figure.label));
        self.paint_methods(&Panel::headed(area, self.case, x, y)?, top)
    }

    fn paint_methods(&self, panel: &Panel<'_, '_>, top: f64) -> Drawn<()> {
        let right = panel.frame.right as i32;
        let mut labels = Labels::within(Block::new((0, 0), (right, panel.frame.bottom as i32)));
        let places = self.places(top);
        for family in 0..self.table.families().len() {
            let line = places.iter().filter(|place| place.0 == family).map(|place| place.1);
            panel.curve(Stroke::solid(1).ink(Mark::of(family).ink()), line)?;
        }
        let front = self.table.front(self.case, self.error);
        let stairs = stairs(front.iter().filter_map(|method| self.place(method, top)));
        panel.curve(FRONT, stairs.iter().copied())?;
        for step in stairs.windows(2) {
            labels.keep_clear_along(panel.point(step[0]), panel.point(step[1]));
        }
        for &(family, place) in &places {
            let mark = Mark::of(family);
            panel.mark(mark, place)?;
            labels.mark(panel.point(place), mark.reach());
        }
        let levels = [(self.figure().floor, self.figure().at_floor), (top, "fails")];
        for (level, word) in levels {
            if places.iter().any(|place| place.1.1 == level) {
                let y = panel.point((1.0, level)).1;
                panel.level(LEVEL, level)?;
                labels.keep_clear_along((0, y), (right, y));
                labels.write_beside(&panel.area, y, word)?;
            }
        }
        for method in front {
            let Some(place) = self.place(method, top) else { continue };
            labels.write(&panel.area, panel.point(place), &method.name)?;
        }
        Ok(())
    }
}

/// From the cheapest to the best: across to the cost of the next method, then down to its error.
fn stairs(front: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut line: Vec<(f64, f64)> = Vec::new();
    for place in front {
        if let Some(&(_, before)) = line.last() {
            line.push((place.0, before));
        }
        line.push(place);
    }
    line
}
