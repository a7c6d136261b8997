//! The steps from a scene to its servo, which a board names where its host has the reason.

/// The step from a scene to its servo that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Step {
    /// To change the numbers.
    Change,
    /// The certificate, with what a board does to a torque: its delay and its limits.
    Certificate,
    /// The servo in its number format, with its transducers.
    Servo,
}

impl Step {
    /// As a word.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Change => "change",
            Self::Certificate => "certificate",
            Self::Servo => "servo",
        }
    }
}
