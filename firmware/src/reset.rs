//! The cause of a board's last reset.

use core::fmt;

/// The cause of a board's last reset, from its chip's reset flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum ResetCause {
    /// Not reported by the chip.
    #[default]
    Unknown = 0,
    /// The supply was switched on.
    PowerOn = 1,
    /// The supply was too low for a while, but not long enough for RAM to lose its contents.
    BrownOut = 2,
    /// The reset pin: a button, or a debug probe.
    Pin = 3,
    /// Requested by the program, or by a debug probe through a register.
    Software = 4,
    /// The independent watchdog: the servo's interrupt stopped.
    IndependentWatchdog = 5,
    /// The window watchdog, which no program here starts.
    WindowWatchdog = 6,
    /// A low-power mode that the option bytes forbid.
    LowPower = 7,
    /// The option bytes were reloaded.
    OptionBytes = 8,
}

impl ResetCause {
    /// All causes, in the order of their numbers.
    pub const ALL: [Self; 9] = [
        Self::Unknown,
        Self::PowerOn,
        Self::BrownOut,
        Self::Pin,
        Self::Software,
        Self::IndependentWatchdog,
        Self::WindowWatchdog,
        Self::LowPower,
        Self::OptionBytes,
    ];

    /// The cause in one word, for tables.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::PowerOn => "power-on",
            Self::BrownOut => "brown-out",
            Self::Pin => "pin",
            Self::Software => "software",
            Self::IndependentWatchdog => "independent-watchdog",
            Self::WindowWatchdog => "window-watchdog",
            Self::LowPower => "low-power",
            Self::OptionBytes => "option-bytes",
        }
    }
}

/// The cause in words.
impl fmt::Display for ResetCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unknown => "unknown cause",
            Self::PowerOn => "power on",
            Self::BrownOut => "brown-out: the supply was too low for a while",
            Self::Pin => "the reset pin",
            Self::Software => "by software",
            Self::IndependentWatchdog => "the independent watchdog",
            Self::WindowWatchdog => "the window watchdog",
            Self::LowPower => "a forbidden low-power mode",
            Self::OptionBytes => "the option bytes were loaded",
        })
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn every_cause_has_a_number_a_word_and_a_sentence_of_its_own() {
        for (number, cause) in ResetCause::ALL.into_iter().enumerate() {
            assert_eq!(cause as usize, number);
            for other in &ResetCause::ALL[..number] {
                assert_ne!(other.as_str(), cause.as_str());
                assert_ne!(other.to_string(), cause.to_string());
            }
        }
    }
}
