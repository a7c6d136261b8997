//! The cause of a board's last reset.

use core::fmt;

use crate::text::words;

words! {
    /// The cause of a board's last reset, from its chip's reset flags.
    #[derive(Default)]
    #[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
    #[repr(u8)]
    ResetCause {
    /// Not reported by the chip.
    #[default]
    Unknown = 0 "unknown",
    /// The supply was switched on.
    PowerOn = 1 "power-on",
    /// The supply was too low for a while, but not long enough for RAM to lose its contents.
    BrownOut = 2 "brown-out",
    /// The reset pin: a button, or a debug probe.
    Pin = 3 "pin",
    /// Requested by the program, or by a debug probe through a register.
    Software = 4 "software",
    /// The independent watchdog: the servo's interrupt stopped.
    IndependentWatchdog = 5 "independent-watchdog",
    /// The window watchdog, which no program here starts.
    WindowWatchdog = 6 "window-watchdog",
    /// A low-power mode that the option bytes forbid.
    LowPower = 7 "low-power",
    /// The option bytes were reloaded.
    OptionBytes = 8 "option-bytes",
    }
}

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
