//! The state of a board as one JSON object, as `haptic tune --json` prints it.

use haptic_servo::certificate::Parameter;
use haptic_servo::wire::message::{ActiveParameters, Status};
use serde::Serialize;
use serde_json::{Map, Value};

use super::client::Connected;
use super::{Power, budget, formatting};

/// The state of a board.
#[derive(Clone, Debug, Serialize)]
pub struct Report<'a> {
    program: &'a str,
    refused: Option<&'a str>,
    sets: u32,
    margin: Option<f64>,
    /// The longest time in s for which a change reduces the torque.
    longest_gap: f64,
    parameters: Map<String, Value>,
    state: &'static str,
    fault: Option<String>,
    remembered: Option<String>,
    /// The cause of the board's last reset, in one word.
    reset: &'static str,
    /// Whether the option bytes let the chip run at a supply that is too low.
    low_brown_out: bool,
    missed: u32,
    worst_slack: Option<f64>,
    energy: f64,
    worst_deficit: f64,
    dropped: u32,
    thinned: u32,
    discarded: u32,
    stack_left: Option<u32>,
    /// Measurements of the power stage, if the board drives the motor itself.
    power: Option<Power>,
}

impl<'a> Report<'a> {
    /// Of a board with these parameters and this status, after a request that it may have refused.
    pub fn of(
        board: &'a Connected,
        refused: Option<&'a str>,
        running: &ActiveParameters,
        status: &Status,
    ) -> Self {
        let units = &board.units;
        let named = |(parameter, value): &(Parameter, f64)| {
            (formatting::name(*parameter).to_owned(), (*value).into())
        };
        let budget = board.budget.map(budget::numbers).into_iter().flatten();
        let budget = budget.map(|(name, value)| (name.to_owned(), value.into()));
        Self {
            program: &board.program,
            refused,
            sets: running.sets,
            margin: running.margin,
            longest_gap: units.longest_gap,
            parameters: running.values.iter().map(named).chain(budget).collect(),
            state: status.state.as_str(),
            fault: status.fault.map(|fault| fault.to_string()),
            remembered: board.previous_fault.as_ref().map(formatting::previous_fault),
            reset: status.reset.as_str(),
            low_brown_out: status.low_brown_out,
            missed: status.missed,
            worst_slack: formatting::worst_slack(status, units),
            energy: status.energy as f64 * units.energy_step,
            worst_deficit: status.worst_deficit as f64 * units.energy_step,
            dropped: status.dropped,
            thinned: status.thinned,
            discarded: status.discarded.total(),
            stack_left: status.stack_left,
            power: status.power.map(Power::from),
        }
    }
}
