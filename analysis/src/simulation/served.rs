//! What the servo did at a sample, so that a record says why a torque is not the one asked for.

use firmware::torque::LimitReason;
use serde::{Serialize, Serializer};

/// What the servo did at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Served {
    /// It ran, and its torque was limited or not.
    Ran(LimitReason),
    /// It did not run: the torque of the tick before stayed.
    Missed,
}

impl Default for Served {
    fn default() -> Self {
        Self::IN_FULL
    }
}

impl Served {
    /// It ran and nothing was limited.
    pub const IN_FULL: Self = Self::Ran(LimitReason::None);

    /// In one word, for tables: the servo's own for what it limited.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Ran(reason) => reason.as_str(),
            Self::Missed => "missed",
        }
    }

    /// Everything that there is, what is served in full first.
    pub fn all() -> impl Iterator<Item = Self> {
        LimitReason::ALL.into_iter().map(Self::Ran).chain([Self::Missed])
    }

    /// What a word of [`Served::as_str`] says; `None` for any other.
    pub fn parse(word: &str) -> Option<Self> {
        Self::all().find(|served| served.as_str() == word)
    }
}

impl Serialize for Served {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_told_apart() {
        assert_eq!(Served::parse("none"), Some(Served::default()));
        assert_eq!(Served::parse("missed"), Some(Served::Missed));
        assert_eq!(Served::parse("torque"), Some(Served::Ran(LimitReason::Torque)));
        assert_eq!(Served::parse("Torque"), None);
        assert!(Served::all().all(|served| Served::parse(served.as_str()) == Some(served)));
    }
}
