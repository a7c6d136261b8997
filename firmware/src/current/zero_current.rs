//! Measurements without a current before each start: the counts of the converters, and the thresholds at which
//! the over-current comparators trip.
//!
//! A comparator's offset, of up to 9 mV, is as much as the voltage of 5 A at its input. So the threshold is not
//! computed from the converters' counts, but found at the comparator itself: while the gates are low, it falls by
//! a code in each instant, over the whole range in which a working comparator trips.

use super::current_loop::Limits;
use super::fault::PowerFault;
use super::modulation::Sample;
use super::power_stage::TripRange;

/// The number of samples in a mean, whose noise is a sixteenth of that of a sample.
const SAMPLES: u32 = 256;

/// The mean of the last whole block of samples, taken while the gates are off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offsets {
    sums: [u32; 2],
    samples: u32,
    /// Sums of the last whole block, so that they are the offsets with eight more bits.
    blocks: Option<[u32; 2]>,
}

impl Offsets {
    /// No block yet.
    pub(super) const NONE: Self = Self { sums: [0; 2], samples: 0, blocks: None };

    /// Takes a sample.
    pub(super) const fn measure(&mut self, sample: &Sample) {
        let [u, v] = self.sums;
        // No sum is above 2^24.
        self.sums = [u + sample.currents[0] as u32, v + sample.currents[1] as u32];
        self.samples += 1;
        if self.samples == SAMPLES {
            *self = Self { blocks: Some(self.sums), ..Self::NONE };
        }
    }

    /// The means in counts, which `f32` holds exactly.
    ///
    /// # Errors
    /// If one is not that of a working amplifier, or no block is complete.
    pub(super) fn checked(&self, limits: &Limits) -> Result<[f32; 2], PowerFault> {
        let sums = self.blocks.unwrap_or_default();
        let (lowest, highest) = (u32::from(limits.offsets.0), u32::from(limits.offsets.1));
        for (phase, sum) in (0..).zip(sums) {
            let count = sum / SAMPLES;
            if self.blocks.is_none() || count < lowest || count > highest {
                return Err(PowerFault::CurrentOffset { phase, count });
            }
        }
        Ok(sums.map(|sum| sum as f32 / SAMPLES as f32))
    }
}

/// The codes at which the comparators of the phases U, V and W trip without a current.
pub type TripCodes = [u16; 3];

/// A running search.
#[derive(Clone, Copy, Debug)]
pub struct TripSearch {
    lowest: u16,
    highest: u16,
    /// The threshold now.
    code: u16,
    /// Zero before the comparator has tripped.
    trips: TripCodes,
}

impl TripSearch {
    /// A search that begins at the highest threshold.
    pub const fn new(range: &TripRange) -> Self {
        let TripRange { lowest, highest, .. } = *range;
        Self { lowest, highest, code: highest, trips: [0; 3] }
    }

    /// The threshold whose outputs the next step takes.
    pub const fn threshold(&self) -> u16 {
        self.code
    }

    /// Takes the comparators' outputs at the threshold; returns the codes at the end of the search.
    ///
    /// # Errors
    /// If a comparator trips already at the highest threshold, or not at the lowest: its phase.
    pub fn step(&mut self, tripped: [bool; 3]) -> Result<Option<TripCodes>, PowerFault> {
        let (code, is_first, is_last) =
            (self.code, self.code == self.highest, self.code <= self.lowest);
        for (phase, (trip, tripped)) in (0..).zip(self.trips.iter_mut().zip(tripped)) {
            if tripped && *trip == 0 {
                *trip = code;
            }
            if is_first && tripped || is_last && *trip == 0 {
                return Err(PowerFault::Comparator { phase, threshold: code.into() });
            }
        }
        self.code = code.saturating_sub(1);
        Ok(is_last.then_some(self.trips))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANGE: TripRange = TripRange { lowest: 140, highest: 180, amps_per_code: 0.5 };

    /// With comparators that trip from these codes down.
    fn found(levels: TripCodes) -> (u32, Result<TripCodes, PowerFault>) {
        let mut search = TripSearch::new(&RANGE);
        for instant in 1..=RANGE.instants() {
            match search.step(levels.map(|level| search.threshold() <= level)) {
                Ok(None) => {}
                Ok(Some(codes)) => return (instant, Ok(codes)),
                Err(fault) => return (instant, Err(fault)),
            }
        }
        panic!("the search does not end")
    }

    #[test]
    fn every_comparator_s_own_code_is_found_in_the_same_time() {
        for levels in [[160, 150, 170], [140, 179, 141]] {
            assert_eq!(found(levels), (RANGE.instants(), Ok(levels)));
        }
    }

    #[test]
    fn a_comparator_that_trips_outside_the_range_is_named() {
        for phase in 0..3 {
            for (level, threshold) in [(0, 140), (139, 140), (180, 180), (4095, 180)] {
                let mut levels = [160; 3];
                levels[phase as usize] = level;
                let fault = PowerFault::Comparator { phase, threshold };
                assert_eq!(found(levels).1, Err(fault));
            }
        }
    }
}
