//! The counts of the currents at zero current.

use super::current_loop::Limits;
use super::fault::PowerFault;
use super::sample::Sample;

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
