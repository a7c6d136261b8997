//! A board on a terminal.

use std::ops::Range;

use anstyle::{AnsiColor, Style};

use super::canvas::{Area, Canvas, DOTS, Line};
use super::control::{self, Control};
use super::sample::Sample;
use super::{Power, Scope, formatting};
use crate::quantity::{shortened, significant};

const PLAIN: Style = Style::new();
const BOLD: Style = Style::new().bold();
const DIM: Style = Style::new().dimmed();

const fn coloured(colour: AnsiColor) -> Style {
    colour.on_default()
}

/// Draws all that is known, on so many columns and rows. In few rows the curves go first, then the facts.
pub fn draw(scope: &Scope, (width, height): (usize, usize)) -> Canvas {
    let mut canvas = Canvas::new(width, height);
    let message = scope.control.message.as_deref().map_or(Vec::new(), |text| wrapped(text, width));
    let (head, facts) = (heading(scope, width), facts_of(scope));
    let last = height.saturating_sub(1);
    let answer = last.saturating_sub(message.len());
    let bottom = answer.saturating_sub(facts.len().max(FACTS)).max(head.len());
    let middle = head.len() + (bottom - head.len()).div_ceil(2);
    draw_curve(&mut canvas, head.len()..middle, scope, "position, rad", |sample| sample.position);
    let torque = |sample: &Sample| sample.torque;
    draw_curve(&mut canvas, middle..bottom, scope, "coupling torque, N m", torque);
    canvas.lines(bottom, &facts);
    canvas.lines(answer, &message);
    canvas.lines(0, &head);
    canvas.lines(last, &[last_line(&scope.control)]);
    canvas
}

/// Lines of facts before the first message of a board, so that the curves keep their place; a power stage has
/// one more.
const FACTS: usize = 4;

/// Most lines of an answer: a refusal names the remedies.
const ANSWER: usize = 5;

fn plain(text: impl Into<String>) -> Line {
    vec![(text.into(), PLAIN)]
}

fn wrapped(text: &str, width: usize) -> Vec<Line> {
    textwrap::wrap(text, width.max(1)).into_iter().take(ANSWER).map(plain).collect()
}

/// The keys, or the line that is typed.
fn last_line(control: &Control) -> Line {
    match &control.prompt {
        None => vec![(control::KEYS.to_owned(), DIM)],
        Some(line) => {
            vec![(format!("tune: {line}_   "), BOLD), (control::PROMPT_KEYS.to_owned(), DIM)]
        }
    }
}

fn heading(scope: &Scope, width: usize) -> Vec<Line> {
    let program = scope.connected.as_ref().map_or("", |connected| &connected.program);
    let mut state = Vec::new();
    if let Some((status, _)) = &scope.status {
        let colour = match (status.fault, status.state.is_armed()) {
            (Some(_), _) => AnsiColor::Red,
            (None, true) => AnsiColor::Green,
            (None, false) => AnsiColor::Yellow,
        };
        state = plain("   ");
        state.push((status.state.as_str().to_owned(), coloured(colour).bold()));
        if status.link_lost {
            let lost = "   the board counts its host as lost".to_owned();
            state.push((lost, coloured(AnsiColor::Yellow)));
        }
    }
    // Shortens the address, not the state: the user knows the address.
    let taken: usize = state.iter().take(2).map(|(text, _)| text.chars().count()).sum();
    let name = shortened(&format!("{program} on {}", scope.address), width.saturating_sub(taken));
    vec![[vec![(name, BOLD)], state].concat(), trouble(scope)]
}

/// The most serious problem.
fn trouble(scope: &Scope) -> Line {
    let before = || scope.connected.as_ref()?.previous_fault.as_ref();
    let fault = scope.status.and_then(|(status, _)| status.fault);
    match (&scope.lost, fault, before()) {
        (Some(why), ..) => vec![(format!("{why}; connecting again"), coloured(AnsiColor::Red))],
        (None, Some(fault), _) => vec![(fault.to_string(), coloured(AnsiColor::Red))],
        (None, None, Some(previous)) => {
            vec![(formatting::previous_fault(previous), coloured(AnsiColor::Yellow))]
        }
        (None, None, None) => Vec::new(),
    }
}

fn facts_of(scope: &Scope) -> Vec<Line> {
    let (Some(connected), Some(parameters), Some((status, here))) =
        (&scope.connected, &scope.parameters, scope.status)
    else {
        return Vec::new();
    };
    let slack = scope.history.last().map(|last| last.slack);
    let energy = formatting::energy(&status, &connected.units);
    let mut lines = vec![
        plain(formatting::numbers(parameters)),
        plain(formatting::reserves(parameters, &status, &connected.units, slack)),
        plain(format!("{energy}   {}", formatting::limits(&scope.history))),
    ];
    lines.extend(status.power.map(|reading| plain(Power::from(reading).to_string())));
    lines.push(vec![(formatting::losses(&status, here), DIM)]);
    lines
}

/// Columns of the numbers beside a curve.
const NUMBERS: usize = 10;

/// Draws a quantity over the last seconds, on these rows.
fn draw_curve(
    canvas: &mut Canvas,
    rows: Range<usize>,
    scope: &Scope,
    title: &str,
    value: impl Fn(&Sample) -> f64 + Copy,
) {
    let now = scope.history.last().map_or("?".to_owned(), |last| significant(value(last), 5));
    let window = scope.history.window();
    let heading = vec![(format!("{title}: {now}"), BOLD), (format!("   last {window} s"), DIM)];
    canvas.lines(rows.start, &[heading]);
    let plot = Area { x: NUMBERS + 2..canvas.width(), y: rows.start + 1..rows.end };
    let (low, high) = range(scope.history.range(value).unwrap_or((0.0, 0.0)));
    let (first, last) = (plot.y.start, plot.y.end - 1);
    let labels = [(first, high), (last, low), ((first + last) / 2, 0.5 * (low + high))];
    for (row, number) in labels.into_iter().take(plot.y.len()) {
        canvas.write((0, row), &format!("{:>NUMBERS$}", significant(number, 4)), PLAIN);
    }
    for row in plot.y.clone() {
        canvas.write((NUMBERS + 1, row), "│", DIM);
    }
    let points = scope.history.curve(plot.x.len() * DOTS.0, value);
    canvas.curve(&plot, &points, &(-window..0.0), &(low..high));
}

/// A range with a height above zero, also for a flat curve.
fn range((low, high): (f64, f64)) -> (f64, f64) {
    let height = (high - low).max(1e-6 * low.abs().max(high.abs()).max(1.0));
    let middle = 0.5 * (low + high);
    (middle - 0.55 * height, middle + 0.55 * height)
}
