//! A stream of torques from this program to a board's motor.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use haptic_model::board::client::Event;
use haptic_model::board::timing::QUERY;
use haptic_servo::servo_loop::State;
use haptic_servo::torque::LimitReason;
use haptic_servo::wire::host::{HostCommand, HostRequest, HostState, LONGEST_REPORT};
use haptic_servo::wire::message::{BoardUnits, ToBoard};
use thiserror::Error;

use super::link::{Link, Wire};
use super::{Address, LinkError};

/// What a streamed torque may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamTick {
    /// Time in s on the board since the stream began.
    pub time: f64,
    /// Angle in rad.
    pub position: f64,
    /// Velocity in rad/s.
    pub velocity: f64,
    /// Energy in J that the budget has left.
    pub energy: f64,
    /// Torque in N m that the board made of the torque before.
    pub torque: f64,
    /// Torque in N m that was wanted and not given.
    pub refused: f64,
    /// The reason for that: the energy, the host's largest torque, or that the servo does not run.
    pub limit: LimitReason,
    /// The servo's state; the torque is zero unless it runs.
    pub state: State,
}

/// Why a stream did not begin, or has ended.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum StreamError {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error("the program {program} takes no torque from a host: its scene has no [host] table")]
    NoHost { program: String },
    #[error(
        "the rate of a stream is {rate} Hz; it must be from {least} to {most} Hz, at least two torques in the host's \
         timeout, at most one in each tick, and no more than the port carries"
    )]
    Rate { rate: f64, least: f64, most: f64 },
    #[error(
        "the function returned a torque of {torque:?} N m at {time} s; it must be a finite number, in the f32 of the \
         wire. The torque is switched off"
    )]
    Torque { torque: f64, time: f64 },
}

/// The slowest stream in Hz: a board that is silent for longer is lost.
const SLOWEST: f64 = 0.5;

/// The most commands whose reports are under way: a second of them at the usual rate.
const UNDER_WAY: u16 = 1000;

/// The torques a second whose reports a serial line carries, at ten bits for a byte.
fn torques_of_line(baud: u32) -> f64 {
    (f64::from(baud) / (10 * LONGEST_REPORT) as f64).floor()
}

/// Counts on the board as positions and times.
struct Counts {
    units: BoardUnits,
    /// The first tick.
    began: u32,
    count: i64,
}

impl Link {
    /// Sends a torque in N m `rate` times a second. The board reports its motion for each, and `function` makes the
    /// next torque of it, or ends the stream by none; while no report comes, the last torque is sent again. On the
    /// way from one torque to the next the board moves along a line if `is_smooth`.
    ///
    /// The stream ends with a torque of zero. If this program stops, the board fades the torque out by itself.
    ///
    /// # Errors
    /// The board takes no torque, the rate or a torque is out of bounds, the link is lost, or `function` fails.
    pub fn stream<E: From<StreamError>>(
        &mut self,
        rate: f64,
        is_smooth: bool,
        mut function: impl FnMut(&StreamTick) -> Result<Option<f64>, E>,
    ) -> Result<(), E> {
        let units = self.board().units;
        let ticks = 1.0 / units.period;
        let most = match self.address() {
            Address::Serial { baud, .. } => ticks.min(torques_of_line(*baud)),
            _ => ticks,
        };
        // From half of the timeout on the board fades a torque out.
        let least = self.board().budget.map_or(SLOWEST, |budget| SLOWEST.max(2.0 / budget.timeout));
        // A rate of 1 / 0.001 s is 1000.0000000000001 Hz or less.
        if !(rate >= least * (1.0 - 1e-9) && rate <= most * (1.0 + 1e-9)) {
            return Err(StreamError::Rate { rate, least, most }.into());
        }
        if self.board().budget.is_none() {
            return Err(StreamError::NoHost { program: self.board().program.clone() }.into());
        }
        let interval = Duration::from_secs_f64(1.0 / rate);
        // The cast saturates.
        let ramp = if is_smooth { (ticks / rate).round() as u16 } else { 0 };
        let wire = self.wire();
        let mut command = HostCommand { number: fastrand::u16(..), torque: 0.0, ramp };
        let streamed = carry(wire, &mut command, units, interval, &mut function);
        let stopped = send(wire, HostCommand { torque: 0.0, ramp: 0, ..command });
        streamed.and(stopped.map_err(|error| StreamError::from(error).into()))
    }
}

fn carry<E: From<StreamError>>(
    wire: &mut Wire,
    command: &mut HostCommand,
    units: BoardUnits,
    interval: Duration,
    function: &mut impl FnMut(&StreamTick) -> Result<Option<f64>, E>,
) -> Result<(), E> {
    let (mut counts, mut sent) = (None::<Counts>, 0_u16);
    let (mut next, mut heard) = (Instant::now(), Instant::now());
    loop {
        send(wire, *command).map_err(StreamError::from)?;
        next += interval;
        sent = sent.saturating_add(1).min(UNDER_WAY);
        let numbers = (command.number, sent);
        // Reports that take longer than an interval come at the rate of the commands: none in some intervals, two in
        // others.
        while let Some(state) = report(wire, numbers, next).map_err(StreamError::from)? {
            heard = Instant::now();
            let counts = counts.get_or_insert(Counts { units, began: state.tick, count: 0 });
            let tick = counts.tick(&state);
            let Some(torque) = function(&tick)? else { return Ok(()) };
            // Also where it has no value in the format of the wire.
            if !(torque as f32).is_finite() {
                return Err(StreamError::Torque { torque, time: tick.time }.into());
            }
            command.torque = torque as f32;
        }
        if heard.elapsed() >= QUERY.end {
            let what = "the torque of a stream";
            return Err(StreamError::from(wire.unanswered(what, QUERY.end)).into());
        }
        // Late by more than an interval: it goes on from now and does not catch up.
        let now = Instant::now();
        if now > next + interval {
            next = now;
        }
        command.number = command.number.wrapping_add(1);
    }
}

fn send(wire: &mut Wire, command: HostCommand) -> Result<(), LinkError> {
    wire.client.send(&ToBoard::Host(HostRequest::Torque(command)));
    wire.flush()
}

/// The next report until a time, if there is one, of a command among so many up to a number. Once it is late, the
/// newest: those before are older than a torque can wait for.
fn report(
    wire: &mut Wire,
    (number, sent): (u16, u16),
    until: Instant,
) -> Result<Option<HostState>, LinkError> {
    let mut newest = None;
    while let Some(event) = wire.next(until)? {
        match event {
            Event::Host(state) if number.wrapping_sub(state.number) < sent => newest = Some(state),
            Event::Lost(_) => return Err(wire.restarted()),
            _ => {}
        }
        if newest.is_some() && Instant::now() < until {
            break;
        }
    }
    Ok(newest)
}

impl Counts {
    fn tick(&mut self, state: &HostState) -> StreamTick {
        let units = &self.units;
        self.count += i64::from(state.count.wrapping_sub(self.count as i32));
        StreamTick {
            time: f64::from(state.tick.wrapping_sub(self.began)) * units.period,
            position: self.count as f64 * TAU / units.counts_per_turn,
            velocity: f64::from(state.velocity),
            energy: f64::from(state.energy),
            torque: f64::from(state.torque),
            refused: f64::from(state.refused),
            limit: state.limit,
            state: state.state,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_carries_a_report_for_each_torque() {
        assert_eq!([115_200, 460_800].map(torques_of_line), [267.0, 1071.0]);
    }
}
