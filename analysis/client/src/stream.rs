//! A stream of torques from this program to a board's motor.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use haptic_model::board::client::Event;
use haptic_model::board::timing::QUERY;
use haptic_servo::servo_loop::State;
use haptic_servo::torque::LimitReason;
use haptic_servo::wire::host::{HostCommand, HostRequest, HostState};
use haptic_servo::wire::message::{BoardUnits, ToBoard};
use thiserror::Error;

use super::LinkError;
use super::link::{Link, Wire};

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
    /// The reason for that.
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
        "the rate of a stream is {rate} Hz; it must be above 0 and at most {most} Hz, a tick each"
    )]
    Rate { rate: f64, most: f64 },
    #[error(
        "the function returned a torque of {torque} N m at {time} s; it must be a finite number. The torque is \
         switched off"
    )]
    Torque { torque: f64, time: f64 },
}

/// Counts on the board as positions and times.
struct Counts {
    units: BoardUnits,
    /// The first tick.
    began: u32,
    count: i64,
}

impl Link {
    /// Sends a torque in N m for the motion that the board reports, `rate` times a second, until `function`
    /// returns none. On the way from one torque to the next the board moves along a line if `is_smooth`.
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
        let most = 1.0 / units.period;
        // A rate of 1 / 0.001 s is 1000.0000000000001 Hz or less.
        if !(rate > 0.0 && rate <= most * (1.0 + 1e-9)) {
            return Err(StreamError::Rate { rate, most }.into());
        }
        if self.board().budget.is_none() {
            return Err(StreamError::NoHost { program: self.board().program.clone() }.into());
        }
        let interval = Duration::from_secs_f64((1.0 / rate).min(QUERY.end.as_secs_f64()));
        // The cast saturates.
        let ramp = if is_smooth { (most / rate).round() as u16 } else { 0 };
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
    let mut counts: Option<Counts> = None;
    let mut next = Instant::now();
    loop {
        send(wire, *command).map_err(StreamError::from)?;
        next += interval;
        let state = reported(wire, *command, next).map_err(StreamError::from)?;
        // Late by more than an interval: it goes on from now and does not catch up.
        next = next.max(Instant::now());
        let counts = counts.get_or_insert(Counts { units, began: state.tick, count: 0 });
        let tick = counts.tick(&state);
        let Some(torque) = function(&tick)? else { return Ok(()) };
        // Also where it has no value in the format of the wire.
        if !(torque as f32).is_finite() {
            return Err(StreamError::Torque { torque, time: tick.time }.into());
        }
        command.number = command.number.wrapping_add(1);
        command.torque = torque as f32;
    }
}

fn send(wire: &mut Wire, command: HostCommand) -> Result<(), LinkError> {
    wire.client.send(&ToBoard::Host(HostRequest::Torque(command)));
    wire.flush()
}

/// The last report of the time until the next command; that of the command itself at least, which is sent again
/// if it gets lost.
fn reported(wire: &mut Wire, command: HostCommand, next: Instant) -> Result<HostState, LinkError> {
    let end = Instant::now() + QUERY.end;
    let (mut last, mut again) = (None, Instant::now() + QUERY.again);
    loop {
        let until = if last.is_some() { next } else { again };
        match wire.next(until)? {
            Some(Event::Host(state)) if state.number == command.number => last = Some(state),
            Some(Event::Lost(_)) => return Err(wire.restarted()),
            Some(_) => {}
            None if Instant::now() >= end => {
                return Err(wire.unanswered("the torque of a stream", QUERY.end));
            }
            None => match last {
                Some(state) => return Ok(state),
                None => {
                    again = Instant::now() + QUERY.again;
                    send(wire, command)?;
                }
            },
        }
    }
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
