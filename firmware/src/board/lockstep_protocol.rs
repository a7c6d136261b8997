//! Lockstep protocol between an emulated board and the host that simulates its plant: the input and
//! the output of a tick, as bytes.
//!
//! Each tick has a number, which the board repeats. A board that faults may report the same tick twice, but
//! never omits it.

use crate::servo_loop::State;

/// The plant's input to a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickInput {
    /// The encoder's counter.
    pub count: u32,
    /// Whole periods without a tick before this tick: 0 if it is in time.
    pub missed: u16,
}

/// The board's output at the end of the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickOutput {
    /// The code that the DAC holds.
    pub code: u16,
    /// Whether the amplifier is on.
    pub amplifier: bool,
    /// State of the servo loop.
    pub state: State,
}

impl TickInput {
    /// Length in bytes.
    pub const BYTES: usize = 8;

    /// As bytes, with the tick's number.
    pub const fn to_bytes(self, number: u16) -> [u8; Self::BYTES] {
        let bits = self.count as u64 | (self.missed as u64) << 32 | (number as u64) << 48;
        bits.to_le_bytes()
    }

    /// From bytes, with the tick's number.
    pub const fn from_bytes(bytes: [u8; Self::BYTES]) -> (Self, u16) {
        let bits = u64::from_le_bytes(bytes);
        (Self { count: bits as u32, missed: (bits >> 32) as u16 }, (bits >> 48) as u16)
    }
}

impl TickOutput {
    /// Length in bytes.
    pub const BYTES: usize = 6;

    /// As bytes, with the tick's number.
    pub const fn to_bytes(self, number: u16) -> [u8; Self::BYTES] {
        let ([a, b], [c, d]) = (self.code.to_le_bytes(), number.to_le_bytes());
        [a, b, self.amplifier as u8, self.state as u8, c, d]
    }

    /// From bytes, with the tick's number; `None` if [`TickOutput::to_bytes`] cannot have written them.
    pub fn from_bytes([a, b, amplifier, state, c, d]: [u8; Self::BYTES]) -> Option<(Self, u16)> {
        let (code, number) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
        let state = State::ALL.into_iter().find(|known| *known as u8 == state)?;
        (amplifier < 2).then_some((Self { code, amplifier: amplifier == 1, state }, number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comes_out_of_the_bytes_as_it_went_in() {
        let input = TickInput { count: 0xffff_fff0, missed: 3 };
        assert_eq!(input.to_bytes(0x1234), [0xf0, 0xff, 0xff, 0xff, 3, 0, 0x34, 0x12]);
        assert_eq!(TickInput::from_bytes(input.to_bytes(0xfedc)), (input, 0xfedc));
        for state in State::ALL {
            let output = TickOutput { code: 0x0123, amplifier: state.is_armed(), state };
            assert_eq!(TickOutput::from_bytes(output.to_bytes(0xabcd)), Some((output, 0xabcd)));
        }
        assert_eq!(TickOutput::from_bytes([0, 8, 2, 0, 0, 0]), None);
        assert_eq!(TickOutput::from_bytes([0, 8, 1, 7, 0, 0]), None);
    }
}
