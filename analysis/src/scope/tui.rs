//! A board on a terminal.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};

use super::control::{self, Control};
use super::sample::Sample;
use super::{Power, Scope, formatting};
use crate::quantity::{shortened, significant};

/// Dots side by side in a character.
const DOTS: usize = 2;

/// Draws all that is known.
pub fn draw(frame: &mut Frame<'_>, scope: &Scope) {
    let width = usize::from(frame.area().width);
    let message =
        scope.control.message.as_deref().map_or(Vec::new(), |message| wrapped(message, width));
    let lines = facts_of(scope);
    let [head, position, torque, facts, answer, keys] = Layout::vertical([
        Constraint::Length(2),
        Constraint::Fill(1),
        Constraint::Fill(1),
        Constraint::Length(lines.len().max(FACTS) as u16),
        Constraint::Length(message.len() as u16),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    frame.render_widget(Paragraph::new(heading(scope, width)), head);
    draw_curve(frame, position, scope, "position, rad", |sample| sample.position);
    draw_curve(frame, torque, scope, "coupling torque, N m", |sample| sample.torque);
    frame.render_widget(Paragraph::new(lines), facts);
    frame.render_widget(Paragraph::new(message), answer);
    frame.render_widget(last_line(&scope.control), keys);
}

/// Lines of facts before the first message of a board, so that the curves keep their place; a power stage has
/// one more.
const FACTS: usize = 4;

/// Most lines of an answer: a refusal names the remedies.
const ANSWER: usize = 5;

fn wrapped(text: &str, width: usize) -> Vec<Line<'static>> {
    let lines = textwrap::wrap(text, width.max(1));
    lines.into_iter().take(ANSWER).map(|line| Line::from(line.into_owned())).collect()
}

/// The keys, or the line that is typed.
fn last_line(control: &Control) -> Line<'_> {
    match &control.prompt {
        None => Line::from(control::KEYS).dim(),
        Some(line) => Line::from(vec![
            Span::from(format!("tune: {line}_   ")).bold(),
            Span::from(control::PROMPT_KEYS).dim(),
        ]),
    }
}

/// Removes the colours from the picture; bold and dim stay.
pub fn without_colour(frame: &mut Frame<'_>) {
    for cell in &mut frame.buffer_mut().content {
        (cell.fg, cell.bg) = (Color::Reset, Color::Reset);
    }
}

fn heading(scope: &Scope, width: usize) -> Vec<Line<'static>> {
    let program = scope.connected.as_ref().map_or("", |connected| &connected.program);
    let mut state = Vec::new();
    if let Some((status, _)) = &scope.status {
        let colour = match (status.fault, status.state.is_armed()) {
            (Some(_), _) => Color::Red,
            (None, true) => Color::Green,
            (None, false) => Color::Yellow,
        };
        state.push(Span::from("   "));
        state.push(Span::styled(status.state.as_str(), Style::new().fg(colour).bold()));
        if status.link_lost {
            state.push(Span::from("   the board counts its host as lost").yellow());
        }
    }
    // Shortens the address, not the state: the user knows the address.
    let taken: usize = state.iter().take(2).map(Span::width).sum();
    let name = shortened(&format!("{program} on {}", scope.address), width.saturating_sub(taken));
    let first = [Span::from(name).bold()].into_iter().chain(state).collect::<Vec<_>>();
    vec![Line::from(first), trouble(scope)]
}

/// The most serious problem.
fn trouble(scope: &Scope) -> Line<'static> {
    if let Some(why) = &scope.lost {
        return Line::from(format!("{why}; connecting again")).red();
    }
    if let Some(fault) = scope.status.and_then(|(status, _)| status.fault) {
        return Line::from(fault.to_string()).red();
    }
    match scope.connected.as_ref().and_then(|connected| connected.previous_fault.as_ref()) {
        Some(previous_fault) => Line::from(formatting::previous_fault(previous_fault)).yellow(),
        None => Line::default(),
    }
}

fn facts_of(scope: &Scope) -> Vec<Line<'static>> {
    let (Some(connected), Some(parameters), Some((status, here))) =
        (&scope.connected, &scope.parameters, scope.status)
    else {
        return Vec::new();
    };
    let slack = scope.history.last().map(|last| last.slack);
    let energy = formatting::energy(&status, &connected.board);
    let mut lines = vec![
        Line::from(formatting::numbers(parameters)),
        Line::from(formatting::reserves(parameters, &status, &connected.board, slack)),
        Line::from(format!("{energy}   {}", formatting::limits(&scope.history))),
    ];
    lines.extend(status.power.map(|reading| Line::from(Power::from(reading).to_string())));
    lines.push(Line::from(formatting::losses(&status, here)).dim());
    lines
}

fn draw_curve(
    frame: &mut Frame<'_>,
    area: Rect,
    scope: &Scope,
    title: &str,
    value: impl Fn(&Sample) -> f64 + Copy,
) {
    let points = scope.history.curve(usize::from(area.width) * DOTS, value);
    let (low, high) = range(scope.history.range(value).unwrap_or((0.0, 0.0)));
    let window = scope.history.window();
    let now = scope.history.last().map_or("?".to_owned(), |last| significant(value(last), 5));
    let label = |number: f64| format!("{:>10}", significant(number, 4));
    let curve =
        Dataset::default().marker(Marker::Braille).graph_type(GraphType::Line).data(&points);
    let chart = Chart::new(vec![curve])
        .block(Block::bordered().title(format!(" {title}: {now} ")))
        .x_axis(
            Axis::default()
                .bounds([-window, 0.0])
                .labels([format!("-{window} s"), "now".to_owned()]),
        )
        .y_axis(Axis::default().bounds([low, high]).labels([
            label(low),
            label(0.5 * (low + high)),
            label(high),
        ]));
    frame.render_widget(chart, area);
}

/// A range with a height above zero, also for a flat curve.
fn range((low, high): (f64, f64)) -> (f64, f64) {
    let height = (high - low).max(1e-6 * low.abs().max(high.abs()).max(1.0));
    let middle = 0.5 * (low + high);
    (middle - 0.55 * height, middle + 0.55 * height)
}
