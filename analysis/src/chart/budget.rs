//! The energy that a hand takes from a host over time, beside the budget: with the tank and without, in the
//! same hand.

use super::*;
use crate::compare_run::RunOutcome;
use crate::hand::HandTrajectory;
use crate::quantity::significant;

/// Heights of the panels in pixels.
const PANELS: [i32; 2] = [300, 220];
/// The lines of the budget, of the servo with its tank and without, and of the hand's set-point.
const BUDGET: Stroke = Stroke::dashed(&[12, 4, 2, 4], 1);
const WITH: Stroke = Stroke::solid(2);
const WITHOUT: Stroke = Stroke::solid(1).faint();
const HAND: Stroke = Stroke::dashed(&[6, 4], 1);
/// Largest shown energy, in budgets at the end of the run.
const SHOWN: f64 = 2.0;
/// Room for the angle without the tank on both sides, in ranges of the others.
const BEYOND: f64 = 0.5;

/// Two runs of the same servo, device, hand and host.
pub struct BudgetRuns {
    /// With the tank, and without.
    pub runs: [RunOutcome; 2],
    /// The hand.
    pub hand: HandTrajectory,
}

/// A run as columns: the end of each tick in s, the energy taken in J, the budget in J, and the angle in rad.
fn columns(outcome: &RunOutcome) -> Vec<[f64; 4]> {
    let Some(host) = &outcome.host else { return Vec::new() };
    let ticks = outcome.run.ticks.iter().enumerate();
    ticks.map(|(i, tick)| [host.time(i), host.taken[i], host.budget_at(i), tick.angle]).collect()
}

impl BudgetRuns {
    fn rows(&self) -> [Vec<[f64; 4]>; 2] {
        self.runs.each_ref().map(columns)
    }

    /// The numbers of the chart.
    pub fn data(&self) -> Data {
        let [with, without] = self.rows();
        let rows = with.into_iter().zip(without).map(|([time, taken, budget, angle], other)| {
            [time, budget, taken, other[1], angle, other[3]].map(Into::into).to_vec()
        });
        let header = "time (s),budget (J),taken (J),taken without tank (J),angle (rad),\
                      angle without tank (rad)";
        Data::new(header, rows)
    }

    /// The energy, and below it the angle.
    ///
    /// # Errors
    /// If there is nothing to draw.
    pub fn draw(&self, title: &str) -> Result<Picture, ChartError> {
        let [with, without] = self.rows();
        let Some(last) = with.last() else { return Err(ChartError::TooFewPoints) };
        let most = self.runs.each_ref().map(|run| {
            let most = run.host.as_ref().map_or(0.0, |host| host.most().0);
            format!("at most {} % of the budget", significant(100.0 * most, 3))
        });
        let budget = self.runs[0].host.as_ref().map(|host| host.budget);
        let [energy, power] = budget.map_or([0.0; 2], |host| [host.energy, host.power]);
        let [energy, power] = [energy, power].map(|value| significant(value, 3));
        // Each line of a tank is that of both panels.
        let entries = [
            (Sample::Line(BUDGET), format!("budget: {energy} J at once and {power} W")),
            (Sample::Line(WITH), format!("with the tank: {}", most[0])),
            (Sample::Line(HAND), "angle that the hand wants, until it lets go".to_owned()),
            (Sample::Line(WITHOUT), format!("without the tank: {}", most[1])),
        ];
        Page::new(title, &PANELS).legend(2, entries).draw(|areas| {
            let least = with.iter().map(|row| row[1]).fold(0.0, f64::min);
            let y = padded(least..SHOWN * last[2], 0.05);
            let x = Axis::linear(0.0..last[0], "");
            let panel = Panel::new(&areas[0], x, Axis::linear(y.clone(), "energy taken (J)"))?;
            // A straight line.
            panel.curve(BUDGET, [with[0], *last].map(|row| (row[0], row[2])))?;
            panel.curve(WITHOUT, points(&without, 1, &y))?;
            panel.curve(WITH, points(&with, 1, &y))?;
            self.angles(&areas[1], [&with, &without], last[0])
        })
    }

    fn angles(&self, area: &Area<'_>, [with, without]: [&[[f64; 4]]; 2], end: f64) -> Drawn<()> {
        let held = with.iter().map(|row| row[0]).take_while(|time| *time < self.hand.release);
        let hand: Vec<_> = held.map(|time| (time, self.hand.position(time))).collect();
        let seen = with.iter().map(|row| row[3]).chain(hand.iter().map(|point| point.1));
        let y = padded(span(seen), BEYOND);
        let x = Axis::linear(0.0..end, "time (s)");
        let panel = Panel::new(area, x, Axis::linear(y.clone(), "angle (rad)"))?;
        panel.curve(WITHOUT, points(without, 3, &y))?;
        panel.curve(WITH, points(with, 3, &y))?;
        panel.curve(HAND, hand)
    }
}

/// A column over time, until it leaves the range.
fn points(
    rows: &[[f64; 4]],
    column: usize,
    range: &Range<f64>,
) -> impl Iterator<Item = (f64, f64)> {
    rows.iter().map(move |row| (row[0], row[column])).take_while(|point| range.contains(&point.1))
}
