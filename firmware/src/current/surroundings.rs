//! Supply and temperature, of which one sample that is off switches nothing off.

use core::hint::cold_path;

use super::current_loop::Limits;
use super::fault::PowerFault;
use super::sample::Sample;

/// Samples in a row out of range that are a fault: noise of the bridge's own edges is in one, and a supply that
/// is really out of its range switches the gates off within three periods of the modulation.
const SAMPLES: u8 = 2;

/// What the last samples said.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    /// Count of the supply, of the last sample in range.
    bus: u16,
    /// Samples in a row that were out of it.
    outside: u8,
}

impl Surroundings {
    /// After a sample in range with this count of the supply.
    pub(super) const fn of(bus: u16) -> Self {
        Self { bus, outside: 0 }
    }

    /// Takes a sample; gives the count of a supply in range, which is not 0.
    ///
    /// # Errors
    /// Where one of the two has been out of its range for some samples in a row.
    #[inline(always)]
    pub(super) fn observe(&mut self, limits: &Limits, sample: &Sample) -> Result<f32, PowerFault> {
        match limits.check_surroundings(sample) {
            Ok(()) => *self = Self::of(sample.bus),
            Err(fault) => {
                cold_path();
                self.outside += 1;
                if self.outside >= SAMPLES {
                    return Err(fault);
                }
            }
        }
        Ok(f32::from(self.bus))
    }
}
