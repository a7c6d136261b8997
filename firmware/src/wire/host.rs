//! The torque of a host on the wire: a command, and the board's report of the tick that took it.
//!
//! A line of 460,800 bit/s carries 46 bytes in a millisecond each way. A command takes at most 19 of them, and
//! its report 43, with frame and checksum: a stream at 1 kHz fits, and a slower one leaves room for telemetry.

use serde::{Deserialize, Serialize};

use super::changes::Id;
use crate::host::{HostTorque, Taken};
use crate::servo_loop::State;
use crate::torque::LimitReason;

/// Bytes of the longest report of a torque on the line, with its frame.
pub const LONGEST_REPORT: usize = 43;

/// The torque that a host wants. The last command wins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HostCommand {
    /// The host's number; comes back with the state.
    pub number: u16,
    /// Torque in N m, positive in the direction of the angle. If it is not finite it counts as zero.
    pub torque: f32,
    /// Ticks over which the torque moves there along a line; with 0 it is there at once.
    pub ramp: u16,
}

/// What a host wants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum HostRequest {
    /// A torque. Answered by [`HostReport::State`] of the tick that takes it.
    Torque(HostCommand),
    /// Another budget, under the rules of other parameters. The tank keeps its energy, as far as the new one
    /// has room for it. Answered by [`Answer`](super::message::ToHostWith::Answer) once it is in force, after a
    /// [`HostReport::Budget`].
    Budget {
        /// Comes back with the answer.
        id: Id,
        /// The budget.
        budget: HostTorque,
    },
}

/// What a host may do, and what became of its torque.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum HostReport {
    /// The budget in force: part of the greeting of a program that takes torques, and sent when it changes.
    Budget(HostTorque),
    /// The tick that took a command.
    State(HostState),
}

/// The tick that took a command. If commands arrive faster than reports can leave, the last one is reported.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HostState {
    /// The command's number.
    pub number: u16,
    /// The number of the tick.
    pub tick: u32,
    /// Low 32 bits of the position in counts.
    pub count: i32,
    /// Mean velocity in rad/s since the last report.
    pub velocity: f32,
    /// Level of the tank in J.
    pub energy: f32,
    /// Torque in N m that this tick gave of the torque before this command.
    pub torque: f32,
    /// Torque in N m that was wanted in this tick and not given.
    pub refused: f32,
    /// The reason for that.
    pub limit: LimitReason,
    /// The servo's state; the torque is zero unless it runs.
    pub state: State,
    /// Commands since the start whose torque was no finite number; stops at its largest value.
    pub invalid: u16,
}

impl HostState {
    /// The state of a tick, with a velocity of one count a tick in rad/s.
    pub(super) fn of(taken: &Taken, count_a_tick: f64) -> Self {
        let Taken { number, tick, count, speed, energy, torque, refused, limit, state, invalid } =
            *taken;
        let state = State::ALL.get(state).copied().unwrap_or_default();
        let velocity = speed * count_a_tick as f32;
        Self { number, tick, count, velocity, energy, torque, refused, limit, state, invalid }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::BAUD;
    use crate::wire::encode;
    use crate::wire::message::{ToBoard, ToHost};

    #[test]
    fn a_stream_at_1_khz_fits_the_line() {
        let command = HostCommand { number: u16::MAX, torque: -1.5, ramp: u16::MAX };
        let state = HostState {
            number: u16::MAX,
            tick: u32::MAX,
            count: i32::MIN,
            velocity: 1.0,
            energy: 1.0,
            torque: 1.0,
            refused: 1.0,
            limit: LimitReason::Energy,
            state: State::Running,
            invalid: u16::MAX,
        };
        let mut buffer = [0; 64];
        let command =
            encode(&ToBoard::Host(HostRequest::Torque(command)), &mut buffer).unwrap().len();
        let report = ToHost::<&str>::Host(HostReport::State(state));
        let report = encode(&report, &mut buffer).unwrap().len();
        assert_eq!((command, report), (19, LONGEST_REPORT));
        // A byte has ten bits on the line.
        assert!(report * 10 * 1000 <= BAUD as usize);
    }
}
