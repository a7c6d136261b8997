//! Checks supply and temperature; a single sample out of range is not a fault.

use core::hint::cold_path;

use super::current_loop::Limits;
use super::fault::PowerFault;
use super::sample::Sample;

/// Consecutive samples out of range that are a fault: noise of the bridge's edges affects one sample, and a
/// supply out of its range switches the gates off within three periods of the modulation.
const SAMPLES: u8 = 2;

/// The result of the last samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    /// Count of the supply, of the last sample in range.
    bus: u16,
    /// Consecutive samples out of range.
    outside: u8,
}

impl Surroundings {
    /// The state after a sample in range with this count of the supply.
    pub(super) const fn of(bus: u16) -> Self {
        Self { bus, outside: 0 }
    }

    /// Takes a sample; returns the count of a supply in range, which is never 0.
    ///
    /// # Errors
    /// If one of the two was out of range in [`SAMPLES`] consecutive samples.
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
