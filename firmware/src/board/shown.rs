//! What an emulated board and the host that simulates its world tell each other in each tick, as
//! bytes.

use crate::cycle::State;

/// What has become of the world since the last tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moved {
    /// The encoder's counter.
    pub count: u32,
    /// Whole periods that went by without a tick: 0 in time.
    pub missed: u32,
}

/// What the board has done by the end of the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown {
    /// What the converter holds.
    pub code: u16,
    /// Whether the amplifier is on.
    pub amplifier: bool,
    /// What the servo says that it is doing.
    pub state: State,
}

impl Moved {
    /// Length in bytes.
    pub const BYTES: usize = 8;

    /// As bytes.
    pub const fn to_bytes(self) -> [u8; Self::BYTES] {
        (self.count as u64 | (self.missed as u64) << 32).to_le_bytes()
    }

    /// From bytes.
    pub const fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let bits = u64::from_le_bytes(bytes);
        Self { count: bits as u32, missed: (bits >> 32) as u32 }
    }
}

impl Shown {
    /// Length in bytes.
    pub const BYTES: usize = 4;

    /// As bytes.
    pub const fn to_bytes(self) -> [u8; Self::BYTES] {
        let [low, high] = self.code.to_le_bytes();
        [low, high, self.amplifier as u8, self.state as u8]
    }

    /// From bytes; `None` for what [`Shown::to_bytes`] did not write.
    pub fn from_bytes([low, high, amplifier, state]: [u8; Self::BYTES]) -> Option<Self> {
        let code = u16::from_le_bytes([low, high]);
        let state = State::ALL.into_iter().find(|known| *known as u8 == state)?;
        (amplifier < 2).then_some(Self { code, amplifier: amplifier == 1, state })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comes_out_of_the_bytes_as_it_went_in() {
        let moved = Moved { count: 0xffff_fff0, missed: 3 };
        assert_eq!(moved.to_bytes(), [0xf0, 0xff, 0xff, 0xff, 3, 0, 0, 0]);
        assert_eq!(Moved::from_bytes(moved.to_bytes()), moved);
        for state in State::ALL {
            let shown = Shown { code: 0x0123, amplifier: state.is_armed(), state };
            assert_eq!(Shown::from_bytes(shown.to_bytes()), Some(shown));
        }
        assert_eq!(Shown::from_bytes([0, 8, 2, 0]), None);
        assert_eq!(Shown::from_bytes([0, 8, 1, 6]), None);
    }
}
