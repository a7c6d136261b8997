//! The search for the thresholds at which the over-current comparators trip without a current.
//!
//! A comparator's offset, of up to 9 mV, is as much as the voltage of 5 A at its input. So the threshold is not
//! computed from the converters' counts, but found at the comparator itself: while the gates are low, it falls by
//! a code in each instant, over the whole range in which a working comparator trips.

use super::fault::PowerFault;

/// The range of codes of the thresholds' converter in which a working comparator trips without a current, and the
/// current of a code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TripRange {
    /// The lowest code.
    pub lowest: u16,
    /// The highest code.
    pub highest: u16,
    /// Current in A of a code.
    pub amps_per_code: f64,
}

impl TripRange {
    /// Instants of a search.
    pub const fn instants(&self) -> u32 {
        (self.highest - self.lowest) as u32 + 1
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
