//! Status of the servo at a sample: the reason for a limited torque, or that the tick was
//! missed.

use haptic_servo::torque::LimitReason;
use serde::{Serialize, Serializer};

/// Status of the servo at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TickStatus {
    /// It ran, and its torque was limited or not.
    Ran(LimitReason),
    /// It did not run: the torque of the tick before stayed.
    Missed,
}

impl Default for TickStatus {
    fn default() -> Self {
        Self::UNLIMITED
    }
}

impl TickStatus {
    /// It ran and nothing was limited.
    pub const UNLIMITED: Self = Self::Ran(LimitReason::None);

    /// In one word, for tables; for a limit, the servo's own word.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Ran(reason) => reason.as_str(),
            Self::Missed => "missed",
        }
    }

    /// All values; a tick without a limit comes first.
    pub fn all() -> impl Iterator<Item = Self> {
        LimitReason::ALL.into_iter().map(Self::Ran).chain([Self::Missed])
    }

    /// Parses a word of [`TickStatus::as_str`]; `None` for any other.
    pub fn parse(word: &str) -> Option<Self> {
        Self::all().find(|status| status.as_str() == word)
    }
}

impl Serialize for TickStatus {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_told_apart() {
        assert_eq!(TickStatus::parse("none"), Some(TickStatus::default()));
        assert_eq!(TickStatus::parse("missed"), Some(TickStatus::Missed));
        assert_eq!(TickStatus::parse("torque"), Some(TickStatus::Ran(LimitReason::Torque)));
        assert_eq!(TickStatus::parse("Torque"), None);
        assert!(TickStatus::all().all(|status| TickStatus::parse(status.as_str()) == Some(status)));
    }
}
