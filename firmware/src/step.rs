//! The steps from a scene to its servo: a board reports the failed step, and its host computes the reason.

/// The step from a scene to its servo that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Step {
    /// Changing the parameters.
    Change,
    /// The certificate, including the board's delay and limits of a torque.
    Certificate,
    /// The servo in its number format, with its transducers.
    Servo,
}

impl Step {
    /// The step as a word.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Change => "change",
            Self::Certificate => "certificate",
            Self::Servo => "servo",
        }
    }
}
