//! The messages. `PROTOCOL.md` describes them for clients in other languages; a test compares it with this
//! file.
//!
//! Text is `&str` where a message is written and where it is read in place, and `String` on a host
//! that keeps it: the bytes are the same.

use core::fmt;
use core::num::NonZeroU32;

use serde::{Deserialize, Serialize};

pub use super::changes::{Changes, Id, MAX_CHANGES, Values};
use super::decoder::Discarded;
use super::description::Description;
use super::host::{HostReport, HostRequest};
use super::telemetry::Batch;
use crate::fault::{Fault, FaultRecord};
use crate::power_reading::PowerReading;
use crate::reset::ResetCause;
use crate::servo::Step;
use crate::servo_loop::State;

/// Version of the messages. Board and host must have the same; [`ToBoard::Hello`] and [`ToHost::Welcome`]
/// have the same beginning in all versions, so that each side can report its version.
pub const PROTOCOL: u16 = 12;

/// Longest message to a board, in bytes: the longest set.
pub const LONGEST_TO_BOARD: usize = 8 + 10 * MAX_CHANGES;
/// Longest message to the host, in bytes: a full batch of ticks, or the description of a program.
pub const LONGEST_TO_HOST: usize = 372;

/// Requests of a host.
pub type ToBoard = ToBoardWith<HostRequest>;

/// Replies and telemetry. `S` is text.
pub type ToHost<S> = ToHostWith<S, HostReport>;

/// Requests to a program that takes requests `C` of a host for torques; a program without a host takes none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToBoardWith<C> {
    /// Requests the identity of the board. Answered by [`ToHost::Welcome`], [`ToHost::PreviousFault`] if
    /// there was a fault, and [`ToHost::Board`]. The same in every version of the protocol.
    Hello,
    /// Requests the active parameters. Answered by [`ToHost::ActiveParameters`].
    Get,
    /// Requests the status. Answered by [`ToHost::Status`].
    Status,
    /// Change these numbers, all or none. Answered by [`ToHost::Answer`], once they run.
    Set {
        /// Comes back with the answer.
        id: Id,
        /// The changes; all other parameters keep their values.
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
    /// Send one tick of every so many from now on; `None`: none. Not answered.
    Stream(Option<NonZeroU32>),
    /// Requests a description of the running scene. Answered by [`ToHost::Described`].
    Describe,
    /// Align a brushless motor on the board's bridge, which moves the handle. Answered by
    /// [`ToHost::Answer`] once it begins; the state is then [`State::Aligning`] until it has ended.
    Align {
        /// Comes back with the answer.
        id: Id,
    },
    /// A torque that the host wants, or another budget for them.
    Host(C),
}

/// Replies and telemetry of a program with reports `R` to a host. `S` is text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "a board has no heap, and one message at a time")]
pub enum ToHostWith<S, R> {
    /// The identity of the board. The same in every version of the protocol, so that a host of another
    /// version can report the mismatch.
    Welcome {
        /// [`PROTOCOL`] of the board.
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
        /// The result.
        outcome: Outcome,
    },
    /// The fault that stopped the board before its last reset.
    PreviousFault(PreviousFault),
    /// Ticks, requested with [`ToBoard::Stream`].
    Telemetry(Batch),
    /// The running scene and its options.
    Described(Description),
    /// What a host may do, and what became of its torque.
    Host(R),
}

/// Units of the other messages on this board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoardUnits {
    /// Period of the servo in s.
    pub period: f64,
    /// Counts of the servo's timer in a period: the unit of a slack.
    pub timer_counts: u32,
    /// Encoder counts per turn.
    pub counts_per_turn: f64,
    /// Motor torque in N m at a full-scale code.
    pub full_scale_torque: f64,
    /// One step of the energy monitor in J.
    pub energy_step: f64,
    /// The longest time in s for which a swap reduces the torque.
    pub longest_gap: f64,
}

/// The active parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActiveParameters {
    /// The number of sets swapped in since the start; wraps.
    pub sets: u32,
    /// Damping in N m s/rad that the device may lose while these parameters run; `None`: unknown.
    pub margin: Option<f64>,
    /// The numbers that can be changed.
    pub values: Values,
}

/// Result of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// The request has taken effect.
    Done,
    /// The request is refused; nothing has changed.
    Refused(Refusal),
}

/// The reason why a request is refused. The host has the same code and computes the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The previous request of this kind is not finished.
    Busy,
    /// A request to disarm is pending; it has priority.
    Disarming,
    /// The fault persists.
    Fault(FaultCode),
    /// This step failed; [`Description::explain`] returns the reason.
    Set(Step),
    /// No alignment begins: because of this fault, or because the servo is armed.
    NotAligning(Option<FaultCode>),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy => f.write_str(
                "the board still works on the previous request of this kind: wait for its answer",
            ),
            Self::Disarming => {
                f.write_str("not armed: the servo is being disarmed; arm it after that")
            }
            Self::Fault(fault) => write!(f, "not armed: {fault}"),
            Self::NotAligning(Some(fault)) => write!(f, "no alignment begins: {fault}"),
            Self::NotAligning(None) => f.write_str(
                "no alignment begins: the servo is armed, and an alignment moves the handle; disarm it first",
            ),
            Self::Set(step) => write!(
                f,
                "the board refused the set by its {}, and this program cannot reproduce the refusal: the board \
                 certifies with the readings of its encoder and its friction, which it does not send, and \
                 `haptic certify` of its scene file tells the reason; or they have different versions",
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
    /// The fault that stopped the servo; `None` after the next arming.
    pub fault: Option<FaultCode>,
    /// Whether the host was silent for too long.
    pub link_lost: bool,
    /// Periods since the start; wraps.
    pub tick: u32,
    /// Position in counts.
    pub count: i64,
    /// The number of sets swapped in since the start; wraps.
    pub sets: u32,
    /// Updates that were missed since the start.
    pub missed: u32,
    /// The smallest slack since the start, in timer counts.
    pub worst_slack: u32,
    /// Net energy that was put into the hand since the servo was armed, in steps.
    pub energy: i64,
    /// The largest value of `energy` since then.
    pub worst_deficit: i64,
    /// Ticks that were dropped because the queue to the wire was full.
    pub dropped: u32,
    /// Ticks of the stream that were omitted because the wire is slower.
    pub thinned: u32,
    /// Invalid frames from the host.
    pub discarded: Discarded,
    /// Bytes of the stack that were never used; `None` if the board does not measure this.
    pub stack_left: Option<u32>,
    /// The cause of the last reset.
    pub reset: ResetCause,
    /// Whether the chip's option bytes let it run at a supply that is too low for its work.
    pub low_brown_out: bool,
    /// The measurements of the power stage; `None` without a bridge on the board.
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
    /// The fault; `None` if this version does not know the code.
    pub fn fault(self) -> Option<Fault> {
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

/// A fault from before the last reset, with its tick and position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PreviousFault {
    /// The fault.
    pub fault: FaultCode,
    /// The tick of the fault; 0 if unknown.
    pub tick: u32,
    /// Low 32 bits of the position in counts; 0 if unknown.
    pub count: i32,
}

impl From<FaultRecord> for PreviousFault {
    fn from(record: FaultRecord) -> Self {
        Self { fault: record.fault.into(), tick: record.tick, count: record.count }
    }
}
