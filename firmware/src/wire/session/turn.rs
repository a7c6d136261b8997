//! The order in which frames leave.

/// The largest number of other messages that are sent before the answer to an accepted request, once the servo
/// has done it, and before a set is certified: one of each other kind, and the other two parts of a greeting.
pub const MESSAGES_AHEAD: usize = Turn::COUNT - 1 + 2;

/// The kinds of frames to the host. They take turns: after a frame, each other kind has its turn before the
/// next frame of the same kind. The parts of a greeting follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    Disarming,
    Arming,
    Alignment,
    Greeting,
    Refusal,
    Status,
    Parameters,
    Description,
    Set,
    Telemetry,
}

impl Turn {
    /// The number of kinds.
    pub(super) const COUNT: usize = 10;
    /// The first turn after a reset.
    pub(super) const FIRST: Self = Self::Disarming;

    /// The kind whose turn follows.
    pub(super) const fn next(self) -> Self {
        match self {
            Self::Disarming => Self::Arming,
            Self::Arming => Self::Alignment,
            Self::Alignment => Self::Greeting,
            Self::Greeting => Self::Refusal,
            Self::Refusal => Self::Status,
            Self::Status => Self::Parameters,
            Self::Parameters => Self::Description,
            Self::Description => Self::Set,
            Self::Set => Self::Telemetry,
            Self::Telemetry => Self::Disarming,
        }
    }
}
