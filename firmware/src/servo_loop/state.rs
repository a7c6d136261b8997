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
    /// The servo renders the scene.
    Running = 2,
    /// The clamp is closing, to disarm or to swap a set of parameters in.
    FadingOut = 3,
    /// The clamp is shut while samples fill the memory of a new set, or the torque output starts up.
    Settling = 4,
    /// A fault stopped it; the amplifier is off.
    Faulted = 5,
    /// A brushless motor is being aligned: its field turns the handle, and no scene is rendered.
    Aligning = 6,
}

impl State {
    /// All states, in the order of their numbers.
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
    /// The state.
    pub state: State,
    /// The fault that stopped the servo, or a fault from before the last reset; `None` after arming.
    pub fault: Option<Fault>,
    /// Periods since the start, wrapping.
    pub tick: u32,
    /// Position in counts.
    pub count: i64,
    /// Timer counts in a period.
    pub period: u32,
    /// The smallest slack since the start, in timer counts: left of a period, or with a fixed phase until the
    /// output of the code.
    pub worst_slack: u32,
    /// Updates missed since the start.
    pub missed: u32,
    /// Frames dropped since the start.
    pub dropped: u32,
    /// Net energy put into the hand since the servo was armed, in counts times codes.
    pub energy: i64,
    /// The largest value of the net energy since then, in counts times codes.
    pub worst_deficit: i64,
    /// Whether the host has been silent for too long.
    pub link_lost: bool,
}

/// A notice to the low-priority task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// The reply to a request for the status.
    Status(Status),
    /// The servo is armed, or was armed already.
    Armed,
    /// The servo was not armed: this fault persists.
    NotArmed(Fault),
    /// The motor is being aligned; [`State::Aligning`] ends by itself.
    Aligning,
    /// The motor is not aligned: because of this fault, or because the servo is armed.
    NotAligning(Option<Fault>),
    /// The amplifier is off.
    Disarmed,
    /// The submitted set is running now.
    Applied,
    /// The servo has stopped.
    Stopped(Fault),
}
