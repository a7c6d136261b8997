//! The pulse-width modulation: its periods in a period of the servo, the samples of each, and its compare values.

use super::error::DriveError;
use crate::encoder::RawCount;

/// Lowest and highest frequency in Hz of the modulation: below, the ripple grows and beats become audible;
/// above, the interrupts take too much of the processor, and the dead time too much of the voltage.
const FREQUENCIES: (f64, f64) = (30e3, 40e3);

/// Relative tolerance of a whole number of counts, for rounding.
const WHOLE: f64 = 1e-9;

/// The modulation's timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PwmTiming {
    /// The reload value: the timer counts up to it and down to zero in a period.
    pub counts: u16,
    /// Periods of the modulation in a period of the servo.
    pub updates: u16,
}

impl PwmTiming {
    /// The highest allowed frequency whose periods fill a period of the servo in s exactly, by a timer with this
    /// clock in Hz.
    ///
    /// # Errors
    /// If there is no such frequency.
    pub const fn of(period: f64, clock: f64) -> Result<Self, DriveError> {
        let wanted = period * clock / 2.0;
        // All casts round positive numbers down; NaN and numbers that are too large do not count as whole.
        let halves = (wanted + 0.5) as u32;
        let is_whole = (wanted - halves as f64).abs() <= WHOLE * wanted;
        let mut updates = (period * FREQUENCIES.1 * (1.0 + WHOLE)) as u16;
        while is_whole && updates as f64 >= period * FREQUENCIES.0 * (1.0 - WHOLE) && updates > 0 {
            let counts = halves / updates as u32;
            if halves.is_multiple_of(updates as u32) && counts <= u16::MAX as u32 {
                return Ok(Self { counts: counts as u16, updates });
            }
            updates -= 1;
        }
        Err(DriveError::Period {
            period,
            lowest: FREQUENCIES.0,
            highest: FREQUENCIES.1,
            nearest: nearest(period, clock),
        })
    }

    /// A period of the modulation in s, as a part of a period of the servo in s.
    pub const fn instant(&self, period: f64) -> f64 {
        period / self.updates as f64
    }

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

/// The longest possible period that a timer can fill, at most `period` and at least one period of the
/// modulation.
const fn nearest(period: f64, clock: f64) -> f64 {
    let updates = whole(period * FREQUENCIES.1 * (1.0 + WHOLE)).max(1.0);
    let least = whole(clock / 2.0 / FREQUENCIES.1) + 1.0;
    let most = whole(clock / 2.0 / FREQUENCIES.0);
    let counts = whole(period * clock / 2.0 / updates).max(least).min(most);
    2.0 * updates * counts / clock
}

/// A positive number, rounded down.
const fn whole(number: f64) -> f64 {
    number as u32 as f64
}

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
