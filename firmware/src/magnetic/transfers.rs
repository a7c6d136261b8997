//! When a board makes the transfers of a chip, and the age that this adds to its readings.

use super::Chip;
use crate::encoder_reading::EncoderReading;
use crate::output_timing::SHORTEST_PHASE;
use crate::time_range::TimeRange;

/// The times of a board's transfers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfers {
    /// Time in s from one to the next.
    pub interval: f64,
    /// Time in s from the beginning of one, where the chip is selected, to the instant of its count.
    pub begins: TimeRange,
    /// Time in s from its end, where the chip sees that it is released, to that instant; negative for an end after it.
    pub ends: TimeRange,
    /// Time in s of its bits after that instant, for which the tick waits.
    pub waits: f64,
}

/// The clock in Hz of the SPI of a board whose transfers begin at the counts.
pub const AT_COUNT_CLOCK: f64 = 170e6;

/// The longest time in s of a transfer that begins at its count, from there to its end.
pub const TRANSFER_WITHIN: f64 = 1e-5;

/// Longest time in s in which the pull-up, of at most 55 kΩ, has a released line high, that of the data or that which
/// selects the chip: a wire of 20 cm has less than 100 pF.
pub const RISE: f64 = 1e-5;

/// Time in s in which the DMA and the SPI begin and end a transfer, besides its bits: an estimate from above.
const MARGIN: f64 = 1e-6;

impl Transfers {
    /// One in each period in s of the servo, from its count on.
    pub const fn at_count(chip: &Chip, period: f64) -> Self {
        Self {
            interval: period,
            begins: TimeRange::ZERO,
            ends: TimeRange::between(-TRANSFER_WITHIN - RISE, 0.0),
            waits: chip.interface.clocks(AT_COUNT_CLOCK) as f64 / AT_COUNT_CLOCK,
        }
    }

    /// One before each update of a current loop, which are `interval` s apart, at an SPI with this clock in Hz:
    /// the current interrupt finds it ended.
    pub const fn before_update(chip: &Chip, interval: f64, clock: f64) -> Self {
        let bits = chip.interface.clocks(clock) as f64 / clock;
        let lead = Self::lead_counts(chip, clock) as f64 / clock;
        let ends = TimeRange::between(-RISE, lead - bits);
        Self { interval, begins: TimeRange::between(bits, lead), ends, waits: 0.0 }
    }

    /// The shortest phase in s of a torque in the period of its count, in whole nanoseconds.
    pub const fn shortest_phase(&self) -> f64 {
        // The cast rounds down.
        (((SHORTEST_PHASE + self.waits) * 1e9) as u32 + 1) as f64 / 1e9
    }

    /// Counts of a timer with the SPI's clock in Hz by which such a transfer begins before its update.
    pub const fn lead_counts(chip: &Chip, clock: f64) -> u16 {
        (chip.interface.clocks(clock) as f64 + MARGIN * clock) as u16 + 1
    }

    /// Transfers in a row that may fail in a scene with these readings and this period in s: each that fails makes a
    /// reading older by an interval, for which the stated age and the readings that may be dropped leave room.
    pub const fn may_fail(&self, chip: &Chip, encoder: &EncoderReading, period: f64) -> u16 {
        const ROUNDED: f64 = 1e-6;
        let stated = encoder.age.most + encoder.dropped as f64 * period;
        ((stated - chip.age_in(self).most) / self.interval + ROUNDED) as u16
    }
}
