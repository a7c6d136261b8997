//! One tick as sent to the host.

use super::State;
use crate::dac::DacCode;
use crate::torque::LimitReason;

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Periods since the servo started, wrapping.
    pub tick: u32,
    /// The position's low 32 bits in counts.
    pub count: i32,
    /// The code that was written.
    pub code: DacCode,
    /// The reason if the torque is limited.
    pub limit: LimitReason,
    /// The servo's state.
    pub state: State,
    /// Timer counts left of the period, or with a fixed phase until the output of the code; 0 if the tick was
    /// late.
    pub slack: u32,
}

/// A receiver of one frame per tick that never waits.
pub trait FrameSink {
    /// Takes a frame, or drops it and counts that.
    fn push(&mut self, frame: Frame);
    /// Frames dropped since the start, wrapping.
    fn dropped(&self) -> u32;
}

/// A frame as words of the queue.
pub(super) type Words = [u32; 4];

impl Frame {
    #[inline(always)]
    pub(super) fn to_words(self) -> Words {
        let small = u32::from(self.code.get())
            | (self.limit as u32) << LIMIT
            | (self.state as u32) << STATE;
        [self.tick, self.count.cast_unsigned(), small, self.slack]
    }

    pub(super) fn from_words([tick, count, small, slack]: Words) -> Self {
        let of = |shift: u32| (small >> shift & 0xff) as usize;
        Self {
            tick,
            count: count.cast_signed(),
            code: DacCode::from_low_bits((small & 0xffff) as u16),
            limit: LimitReason::ALL.get(of(LIMIT)).copied().unwrap_or_default(),
            state: State::ALL.get(of(STATE)).copied().unwrap_or_default(),
            slack,
        }
    }
}

const LIMIT: u32 = 16;
const STATE: u32 = 24;
