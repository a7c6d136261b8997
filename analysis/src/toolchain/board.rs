//! The boards that programs can be flashed to.

use std::fmt;

/// A board; each is a feature of the firmware's package, a file in its `board` folder, and a virtual board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BoardModel {
    /// NUCLEO-G474RE.
    NucleoG474re,
    /// B-G431B-ESC1 and boards like it.
    BG431bEsc1,
    /// The Adafruit Feather STM32F405 Express.
    FeatherStm32f405,
}

/// The torque output of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum TorqueOutput {
    /// Its DAC, with an external current amplifier.
    Dac,
    /// Its own bridge.
    Bridge,
}

/// The error for an unknown board.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no board {name}; there are {}", BoardModel::ALL.map(BoardModel::name).join(", "))]
pub struct UnknownBoard {
    /// The given name.
    pub name: String,
}

impl BoardModel {
    /// All boards.
    pub const ALL: [Self; 3] = [Self::NucleoG474re, Self::BG431bEsc1, Self::FeatherStm32f405];

    /// Its name, which is also the feature's, and the size of its chip's flash in KiB, from the data sheet.
    const fn facts(self) -> (&'static str, u64) {
        match self {
            Self::NucleoG474re => ("nucleo-g474re", 512),
            Self::BG431bEsc1 => ("b-g431b-esc1", 128),
            Self::FeatherStm32f405 => ("feather-stm32f405", 1024),
        }
    }

    /// Its name, which is also the feature's.
    pub const fn name(self) -> &'static str {
        self.facts().0
    }

    /// Size of its chip's flash in bytes.
    pub const fn flash(self) -> u64 {
        self.facts().1 << 10
    }

    /// Whether it has a bridge that this firmware drives.
    pub const fn has_bridge(self) -> bool {
        matches!(self, Self::BG431bEsc1)
    }

    /// Whether it reads the chip of a magnetic encoder beside this output.
    pub const fn reads_chips(self, output: TorqueOutput) -> bool {
        matches!(
            (self, output),
            (Self::NucleoG474re, TorqueOutput::Dac) | (Self::BG431bEsc1, TorqueOutput::Bridge)
        )
    }

    /// The board of that name.
    pub fn find(name: &str) -> Result<Self, UnknownBoard> {
        let found = Self::ALL.into_iter().find(|board| board.name() == name);
        found.ok_or_else(|| UnknownBoard { name: name.into() })
    }
}

impl fmt::Display for BoardModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
