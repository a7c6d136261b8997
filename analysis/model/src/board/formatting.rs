//! The state of a board as text.

use haptic_servo::certificate::Parameter;
use haptic_servo::tuning;
use haptic_servo::wire::Discarded;
use haptic_servo::wire::message::{ActiveParameters, BoardUnits, PreviousFault, Status};

use super::history::History;
use crate::quantity::significant;

/// The active numbers, as they are typed: `stiffness=22 damping=0.01`.
pub fn numbers(parameters: &ActiveParameters) -> String {
    changes(&parameters.values)
}

/// Parameters as they are typed.
pub fn changes(changes: &[(Parameter, f64)]) -> String {
    named(changes.iter().map(|(parameter, value)| (name(*parameter), *value)).collect::<Vec<_>>())
}

/// The same by their names.
pub fn named(changes: impl AsRef<[(&'static str, f64)]>) -> String {
    let each = changes.as_ref().iter().map(|(name, value)| format!("{name}={value}"));
    each.collect::<Vec<_>>().join(" ")
}

/// A parameter as it is typed.
pub fn name(parameter: Parameter) -> &'static str {
    tuning::name(parameter).unwrap_or(parameter.name_and_unit().0)
}

/// The fault that stopped the board before its last reset.
pub fn previous_fault(previous_fault: &PreviousFault) -> String {
    format!("before the last reset, in tick {}: {}", previous_fault.tick, previous_fault.fault)
}

/// Why the board was last reset, and whether it is reset by a supply that is too low.
pub fn reset(status: &Status) -> String {
    let warning = if status.low_brown_out {
        "; warning: the option byte BOR_LEV lets the chip run at a supply that is too low (boards.md, Resets)"
    } else {
        ""
    };
    format!("last reset: {}{warning}", status.reset)
}

/// The reserves of the certificate (margin) and of the time (slack); `slack` in s is that of the last tick.
pub fn reserves(
    parameters: &ActiveParameters,
    status: &Status,
    board: &BoardUnits,
    slack: Option<f64>,
) -> String {
    let margin = parameters.margin;
    let margin = margin.map_or("none".to_owned(), |m| format!("{} N m s/rad", significant(m, 4)));
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let now = slack.map(|slack| format!("{}, ", percent(slack / board.period))).unwrap_or_default();
    let worst = worst_slack(status, board).map_or("unknown".to_owned(), percent);
    format!("margin {margin}   slack {now}worst {worst}   missed {}", status.missed)
}

/// The worst slack as a share of the period; `None` before the first tick.
pub fn worst_slack(status: &Status, board: &BoardUnits) -> Option<f64> {
    let counts = status.worst_slack;
    (counts <= board.timer_counts).then(|| f64::from(counts) / f64::from(board.timer_counts))
}

/// The longest time without torque while an armed board changes its numbers.
pub fn gap(board: &BoardUnits) -> String {
    let gap = significant(1e3 * board.longest_gap, 3);
    format!("the torque was released for up to {gap} ms while the set was swapped in")
}

/// Energy that went into the hand.
pub fn energy(status: &Status, board: &BoardUnits) -> String {
    let joule = |steps: i64| significant(steps as f64 * board.energy_step, 3);
    let (net, worst) = (joule(status.energy), joule(status.worst_deficit));
    format!("energy into the hand {net} J, at most {worst} J")
}

/// The reasons for limited torques.
pub fn limits(history: &History) -> String {
    let limits = history.limits();
    if limits.is_empty() {
        return "limited by nothing".to_owned();
    }
    let each = limits.iter().map(|(reason, share)| format!("{reason} {:.0} %", 100.0 * share));
    format!("limited by {}", each.collect::<Vec<_>>().join(", "))
}

/// Lost ticks and bad frames; `here` counts the frames that the host could not read.
pub fn losses(status: &Status, here: Discarded) -> String {
    let (there, here) = (status.discarded.total(), here.total());
    let Status { dropped, thinned, .. } = status;
    format!("ticks dropped {dropped}, thinned {thinned}   bad frames: board {there}, host {here}")
}
