//! The samples of an instant, and the compare values for the next one.

use super::timing::PwmTiming;
use crate::encoder::RawCount;

/// The samples of one instant of the modulation, in the middle of the low sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Counts of the currents of the phases U and V.
    pub currents: [u16; 2],
    /// Count of the supply.
    pub bus: u16,
    /// Count of the temperature.
    pub temperature: u16,
    /// The encoder's counter.
    pub position: RawCount,
}

/// Compare values of the phases U, V and W: the high side conducts while the timer is below. A brushed motor is
/// between U and V, and W is at half.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Duties(pub [u16; 3]);

impl PwmTiming {
    /// No voltage: all phases at half.
    pub(super) const fn no_voltage(self) -> Duties {
        Duties([self.counts / 2; 3])
    }

    /// A voltage from U to V, as the difference of their compare values, symmetric about half, rounded to the
    /// nearest.
    #[inline(always)]
    pub(super) const fn between_two(self, difference: f32) -> Duties {
        // The cast rounds a positive number down.
        let high = (difference + (self.counts as f32 + 0.5)) as u32;
        let above = high >> 1;
        let below = self.counts as u32 - (high - above);
        Duties([above as u16, below as u16, self.counts / 2])
    }
}
