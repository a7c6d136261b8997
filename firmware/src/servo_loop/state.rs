//! The state of the servo, its status and its notices.

use core::fmt;

use crate::fault::Fault;

/// The servo's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum State {
    /// The amplifier is off.
    #[default]
    Disarmed = 0,
    /// The clamp is opening.
    FadingIn = 1,
    /// The scene is felt.
    Running = 2,
    /// The clamp is closing, to disarm or to swap a set of parameters in.
    FadingOut = 3,
    /// The clamp is shut while a new set fills its memory with samples.
    Settling = 4,
    /// A fault stopped it; the amplifier is off.
    Faulted = 5,
    /// A brushless motor is aligned: its field turns the handle, and no scene is felt.
    Aligning = 6,
}

impl State {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 7] = [
        Self::Disarmed,
        Self::FadingIn,
        Self::Running,
        Self::FadingOut,
        Self::Settling,
        Self::Faulted,
        Self::Aligning,
    ];

    /// The state in one word, for tables.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Disarmed => "disarmed",
            Self::FadingIn => "fading-in",
            Self::Running => "running",
            Self::FadingOut => "fading-out",
            Self::Settling => "settling",
            Self::Faulted => "faulted",
            Self::Aligning => "aligning",
        }
    }

    /// Whether the amplifier is on.
    pub const fn is_armed(self) -> bool {
        !matches!(self, Self::Disarmed | Self::Faulted)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// The servo's reply to a request for its status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// Its state.
    pub state: State,
    /// The fault that stopped it, or that was left from before the last reset; until it is armed.
    pub fault: Option<Fault>,
    /// Periods since the start, wrapping.
    pub tick: u32,
    /// Position in counts.
    pub count: i64,
    /// Timer counts in a period.
    pub period: u32,
    /// The least timer counts that were left since the start: of a period, or until a code was put out
    /// where that has a phase of its own.
    pub worst_slack: u32,
    /// Updates missed since the start.
    pub missed: u32,
    /// Frames dropped since the start.
    pub dropped: u32,
    /// Net energy put into the hand since the servo was armed, in counts times codes.
    pub energy: i64,
    /// The worst deficit since then, in counts times codes.
    pub worst_deficit: i64,
    /// Whether the host has been silent for too long.
    pub link_lost: bool,
}

/// A notice to the low-priority task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// The answer to a question for the status.
    Status(Status),
    /// The servo is armed, or was so already.
    Armed,
    /// The servo was not armed: what stopped it is still there.
    NotArmed(Fault),
    /// The motor is being aligned; [`State::Aligning`] ends by itself.
    Aligning,
    /// It is not: because of this fault, or because the servo is armed.
    NotAligning(Option<Fault>),
    /// The amplifier is off.
    Disarmed,
    /// The submitted set is running now.
    Applied,
    /// The servo has stopped.
    Stopped(Fault),
}
