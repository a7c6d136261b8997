//! `haptic tune`: the parameters of a running board.

use std::io::{self, Write};
use std::thread;
use std::time::Duration;

use clap::Args;
use haptic_model::board::{Report, budget};
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{ActiveParameters, FaultCode, Status};

use super::shared_arguments::{JsonOption, json};
use super::status::{CommandError, CommandStatus};
use crate::link::change::{Name, change, collect};
use crate::link::{self, Address, Link, Request};
use crate::scope::{Power, formatting, modes};

#[derive(Debug, Args)]
#[command(after_help = "An armed board takes the torque away while it swaps a set in: the torque \
                        fades out, the new set starts at rest where the device is, and the torque \
                        fades in. With the default fading of 0.1 s and a period of 1 ms this takes \
                        up to 36 ms; the answer has the longest time.")]
pub struct Arguments {
    /// Address of the board: /dev/ttyACM0 (@BAUD), tcp://HOST:PORT, unix:PATH
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Parameters to change together, in SI units: stiffness=30 damping=0.01. A set that does not
    /// certify changes nothing. The budget of a host changes alone: host.energy=0.1 host.power=0. Without
    /// parameters: print the running ones
    #[arg(value_name = "NAME=VALUE", value_parser = change)]
    pub changes: Vec<(Name, f64)>,
    /// Switch the amplifier on after the change; clears a fault
    #[arg(long, conflicts_with = "disarm")]
    pub arm: bool,
    /// Switch the amplifier off before the change
    #[arg(long)]
    pub disarm: bool,
    /// Align the brushless motor of a motor board, after a change and before --arm: its field turns the handle
    /// for some seconds. Keep the hand off. Needed once after each reset, unless the program states the
    /// offset of the encoder's index, which is printed once the index has come
    #[arg(long)]
    pub align: bool,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// Time between two polls for the end of an alignment.
const POLL: Duration = Duration::from_millis(200);

/// Sends the request and prints the active parameters. A refusal is a negative verdict.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let changes = collect(&arguments.changes)?;
    let mut link = Link::open(&arguments.port)?;
    let swaps =
        !arguments.changes.is_empty() && !arguments.disarm && link.status()?.state.is_armed();
    let outcome = request(&mut link, arguments, changes)?;
    let refused = match &outcome {
        link::RequestResult::Done => None,
        link::RequestResult::Refused(sentence) => Some(sentence.as_str()),
    };
    let (running, status) = (link.parameters()?, link.status()?);
    if arguments.answer.json {
        json(io::stdout(), &Report::of(link.board(), refused, &running, &status))?;
    } else {
        print(&link, refused, &running, &status)?;
        if refused.is_none() && swaps {
            writeln!(io::stdout(), "{}", formatting::gap(&link.board().units))?;
        }
    }
    Ok(if refused.is_none() { CommandStatus::Success } else { CommandStatus::NegativeVerdict })
}

/// Each step only if the previous step was done.
fn request(
    link: &mut Link,
    arguments: &Arguments,
    changes: Request,
) -> Result<link::RequestResult, CommandError> {
    let mut outcome = link::RequestResult::Done;
    if arguments.disarm {
        outcome = link.disarm()?;
    }
    if outcome == link::RequestResult::Done && !arguments.changes.is_empty() {
        outcome = link.request(changes)?;
    }
    if outcome == link::RequestResult::Done && arguments.align {
        outcome = align(link)?;
    }
    if outcome == link::RequestResult::Done && arguments.arm {
        outcome = link.arm()?;
    }
    Ok(outcome)
}

/// Aligns the motor, and waits for the end.
fn align(link: &mut Link) -> Result<link::RequestResult, CommandError> {
    let outcome = link.request(Request::Align)?;
    if outcome != link::RequestResult::Done {
        return Ok(outcome);
    }
    loop {
        let status = link.status()?;
        if status.state != State::Aligning {
            let failed = |fault: FaultCode| link::RequestResult::Refused(fault.to_string());
            return Ok(status.fault.map_or(link::RequestResult::Done, failed));
        }
        thread::sleep(POLL);
    }
}

fn print(
    link: &Link,
    refused: Option<&str>,
    running: &ActiveParameters,
    status: &Status,
) -> Result<(), CommandError> {
    let board = &link.board().units;
    if let Some(sentence) = refused {
        writeln!(io::stderr(), "{sentence}")?;
    }
    let mut lines =
        vec![format!("{} on {}: {}", &link.board().program, link.address(), status.state)];
    lines.extend(status.fault.map(|fault| format!("stopped: {fault}")));
    lines.extend(link.board().previous_fault.as_ref().map(formatting::previous_fault));
    lines.extend([formatting::reset(status), formatting::numbers(running)]);
    lines.extend(link.board().budget.map(|host| formatting::named(budget::numbers(host))));
    lines.extend(modes::modes(&link.board().program, running));
    lines.push(formatting::reserves(running, status, board, None));
    lines.push(formatting::energy(status, board));
    if let Some(power) = status.power.map(Power::from) {
        lines.push(power.to_string());
        lines.extend(power.index_offset());
    }
    lines.push(formatting::losses(status, link.discarded()));
    writeln!(io::stdout(), "{}", lines.join("\n"))?;
    Ok(())
}
