//! The messages. `PROTOCOL.md` has the same for clients in other languages, and a test holds it against this
//! file.
//!
//! Text is `&str` where a message is written and where it is read in place, and `String` on a host
//! that keeps it: the bytes are the same.

use core::fmt;
use core::num::NonZeroU32;

use serde::{Deserialize, Serialize};

pub use super::changes::{Changes, MAX_CHANGES};
use super::decoder::Discarded;
use super::description::Description;
use super::telemetry::Batch;
use crate::fault::{Fault, FaultRecord};
use crate::power_reading::PowerReading;
use crate::reset::ResetCause;
use crate::servo::Step;
use crate::servo_loop::State;

/// Longest message to a board, in bytes: the longest set, nine bytes a number.
pub const LONGEST_TO_BOARD: usize = 8 + 10 * MAX_CHANGES;
/// Longest message to the host, in bytes: a full batch of ticks, and a program described.
pub const LONGEST_TO_HOST: usize = 352;

/// The host's number for a request, which comes back with the answer.
pub type Id = u16;

/// Requests of a host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToBoard {
    /// Who is there? Answered by [`ToHost::Welcome`], [`ToHost::PreviousFault`] where a fault
    /// is, and [`ToHost::Board`]. The same in every version of the protocol.
    Hello,
    /// Which numbers are running? Answered by [`ToHost::ActiveParameters`].
    Get,
    /// How is it going? Answered by [`ToHost::Status`].
    Status,
    /// Change these numbers, all or none. Answered by [`ToHost::Answer`], once they run.
    Set {
        /// Comes back with the answer.
        id: Id,
        /// What to change; the other numbers stay as they run.
        changes: Changes,
    },
    /// Switch the amplifier on, or clear a fault and do so. Answered by [`ToHost::Answer`].
    Arm {
        /// Comes back with the answer.
        id: Id,
    },
    /// Fade the torque out and switch the amplifier off. Answered by [`ToHost::Answer`].
    Disarm {
        /// Comes back with the answer.
        id: Id,
    },
    /// Send every so many ticks from now on; `None`: no more. Not answered.
    Stream(Option<NonZeroU32>),
    /// What exactly is running? Answered by [`ToHost::Described`].
    Describe,
    /// Align a brushless motor on the board's bridge, which moves the handle. Answered by
    /// [`ToHost::Answer`] once it begins; the state is then [`State::Aligning`] until it has ended.
    Align {
        /// Comes back with the answer.
        id: Id,
    },
}

/// Replies and telemetry. `S` is text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "a board has no heap, and one message at a time")]
pub enum ToHost<S> {
    /// Who answers. The same in every version of the protocol, so that a host of another version
    /// can say so.
    Welcome {
        /// [`super::PROTOCOL`] of the board.
        protocol: u16,
        /// Name of the program.
        program: S,
    },
    /// Units of the other messages on this board.
    Board(BoardUnits),
    /// The active parameters.
    ActiveParameters(ActiveParameters),
    /// How it is going.
    Status(Status),
    /// Result of a request.
    Answer {
        /// The request's.
        id: Id,
        /// What became of it.
        outcome: Outcome,
    },
    /// What stopped this board before it was last started.
    PreviousFault(PreviousFault),
    /// Ticks, requested with [`ToBoard::Stream`].
    Telemetry(Batch),
    /// The scene that runs, and how.
    Described(Description),
}

/// Units of the other messages on this board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoardUnits {
    /// Period of the servo in s.
    pub period: f64,
    /// Counts of the servo's timer in a period: the unit of a slack.
    pub timer_counts: u32,
    /// Encoder counts a turn.
    pub counts_per_turn: f64,
    /// Motor torque in N m at the codes of full scale.
    pub full_scale_torque: f64,
    /// One step of the energy monitor in J.
    pub energy_step: f64,
    /// The longest time in s for which swapping a set in takes the torque away.
    pub longest_gap: f64,
}

/// The active parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActiveParameters {
    /// Sets that were swapped in since the start; wraps.
    pub sets: u32,
    /// Damping in N m s/rad that the device may lose with these numbers running; `None`: not known.
    pub margin: Option<f64>,
    /// The numbers that can be changed.
    pub values: Changes,
}

/// Result of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// The request has taken effect.
    Done,
    /// It is refused, and nothing has changed.
    Refused(Refusal),
}

/// Why a request is refused. The words are the host's, which has the same code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// One set at a time.
    Busy,
    /// It is to be disarmed, which goes first.
    Disarming,
    /// The fault is still there.
    Fault(FaultCode),
    /// This step failed; [`Description::explain`] has the reason.
    Set(Step),
    /// No alignment begins: because of this fault, or because the servo is armed.
    NotAligning(Option<FaultCode>),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy => f.write_str(
                "the previous set of parameters is still being swapped in: wait for its answer",
            ),
            Self::Disarming => f.write_str(
                "not armed: the servo is being disarmed; arm it after \
                                            that",
            ),
            Self::Fault(fault) => write!(f, "not armed: {fault}"),
            Self::NotAligning(Some(fault)) => write!(f, "no alignment begins: {fault}"),
            Self::NotAligning(None) => f.write_str(
                "no alignment begins: the servo is armed, and an alignment moves the handle; disarm it first",
            ),
            Self::Set(step) => write!(
                f,
                "the board refused the set by its {}, and this program cannot reproduce the \
                 refusal: they have different versions",
                step.as_str()
            ),
        }
    }
}

/// How it is going.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// The servo's state.
    pub state: State,
    /// What stopped it, until it is armed again.
    pub fault: Option<FaultCode>,
    /// Whether the host was silent for too long.
    pub link_lost: bool,
    /// Periods since the start; wraps.
    pub tick: u32,
    /// Position in counts.
    pub count: i64,
    /// Sets of parameters that were swapped in since the start; wraps.
    pub sets: u32,
    /// Updates that were missed since the start.
    pub missed: u32,
    /// The least timer counts that were left of a period since the start.
    pub worst_slack: u32,
    /// Net energy that was put into the hand since the servo was armed, in steps.
    pub energy: i64,
    /// The most that this has been.
    pub worst_deficit: i64,
    /// Ticks that found the queue to the wire full.
    pub dropped: u32,
    /// Ticks of the stream that were left out because the wire is slower.
    pub thinned: u32,
    /// Frames from the host that were none.
    pub discarded: Discarded,
    /// Bytes of the stack that were never used, where the board can tell.
    pub stack_left: Option<u32>,
    /// Why the board was last reset.
    pub reset: ResetCause,
    /// What its power stage measures, where the torque is that of its own bridge.
    pub power: Option<PowerReading>,
}

/// A [`Fault`] on the wire: a code and two numbers, so that a host that does not know the fault can
/// still name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultCode {
    /// The code of [`Fault::encode`].
    pub code: u32,
    /// Its numbers.
    pub numbers: [u32; 2],
}

impl From<Fault> for FaultCode {
    fn from(fault: Fault) -> Self {
        let (code, numbers) = fault.encode();
        Self { code, numbers }
    }
}

impl FaultCode {
    /// The fault; `None` where this version knows none of that code.
    pub const fn fault(self) -> Option<Fault> {
        Fault::decode(self.code, self.numbers)
    }
}

impl fmt::Display for FaultCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.fault(), self.numbers) {
            (Some(fault), _) => fault.fmt(f),
            (None, [a, b]) => {
                write!(f, "unknown fault: {} ({a}, {b})", self.code)
            }
        }
    }
}

/// A fault of before the last reset, and when and where it happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PreviousFault {
    /// What happened.
    pub fault: FaultCode,
    /// In which tick; 0 where that is not known.
    pub tick: u32,
    /// Low 32 bits of the position in counts; 0 where that is not known.
    pub count: i32,
}

impl From<FaultRecord> for PreviousFault {
    fn from(record: FaultRecord) -> Self {
        Self { fault: record.fault.into(), tick: record.tick, count: record.count }
    }
}
