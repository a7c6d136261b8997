//! What runs at each instant: from a sample and a code to compare values.

use super::current_loop::CurrentLoop;
use super::fault::PowerFault;
use super::follower::Follower;
use super::motor::Winding;
use super::offset::Offsets;
use super::sample::{Duties, Sample};
use super::speed::Speed;
use super::supervision::Supervision;

/// A current loop that runs.
#[derive(Clone, Copy, Debug)]
pub struct CurrentController {
    design: CurrentLoop,
    offsets: Offsets,
    /// Supply and temperature before the gates are switched on.
    last: Option<Sample>,
    /// Of the phases U and V, in counts, as the last start took them over.
    offset: [f32; 2],
    follower: Follower,
    speed: Speed,
    supervision: Supervision,
}

impl CurrentController {
    /// A controller whose gates are off.
    pub const fn new(design: &CurrentLoop) -> Self {
        Self {
            design: *design,
            offsets: Offsets::NONE,
            last: None,
            offset: [0.0; 2],
            follower: Follower::AT_REST,
            speed: Speed::new(design.counter),
            supervision: Supervision::NONE,
        }
    }

    /// Takes a sample while the gates are off: the counts without a current.
    pub fn measure_offset(&mut self, sample: &Sample) {
        self.offsets.measure(sample);
        self.speed.restart(sample.position);
        self.last = Some(*sample);
    }

    /// Gets ready for gates that are switched on before the next instant: no current and no voltage. The code
    /// has to be that of no torque.
    ///
    /// # Errors
    /// Where the offsets, the supply or the temperature of the last sample are out of range.
    pub fn start(&mut self) -> Result<(), PowerFault> {
        self.offset = self.offsets.checked(&self.design.limits)?;
        if let Some(sample) = self.last {
            self.design.limits.check_surroundings(&sample)?;
        }
        (self.follower, self.supervision) = (Follower::AT_REST, Supervision::NONE);
        Ok(())
    }

    /// One instant: the compare values to be loaded at the next one, for a code as
    /// [`DacCode::offset`](crate::dac::DacCode::offset) gives it.
    ///
    /// # Errors
    /// Faults, after which the gates are to be switched off.
    #[inline(always)]
    pub fn step(&mut self, sample: &Sample, code_offset: i16) -> Result<Duties, PowerFault> {
        match self.design.winding {
            Winding::Brushed => self.step_brushed(sample, code_offset),
            Winding::Brushless { .. } => Ok(self.design.no_voltage()),
        }
    }

    /// The fault of a comparator that has taken the gates away, with the larger of the two currents of the
    /// instant after it.
    #[cold]
    pub fn over_current(&self, sample: &Sample) -> PowerFault {
        let counts = |phase: usize| (f32::from(sample.currents[phase]) - self.offset[phase]).abs();
        self.design.limits.over_current(counts(0).max(counts(1)))
    }

    /// The same of a brushed motor.
    #[inline(always)]
    fn step_brushed(&mut self, sample: &Sample, code_offset: i16) -> Result<Duties, PowerFault> {
        let CurrentLoop { law, output, limits, timing, .. } = &self.design;
        limits.check(sample, self.offset)?;
        let [u, v] = sample.currents.map(f32::from);
        // Both shunts see the current, with opposite signs; half the difference has half the step.
        let current = 0.5 * law.amps_per_count * ((u - v) - (self.offset[0] - self.offset[1]));
        let back_emf = law.back_emf * self.speed.update(sample.position);
        let reference = law.amps_per_code * f32::from(code_offset);
        let wanted = self.follower.follow(law, reference, current);
        // The supply changes from instant to instant: the only division.
        let counts = (wanted.volts + back_emf) * (output.counts_per_volt / f32::from(sample.bus));
        let span = f32::from(output.span);
        let limited = counts.clamp(-span, span);
        let is_limited = limited != counts;
        self.follower.integrate(
            law,
            wanted.deviation,
            is_limited && wanted.deviation * counts > 0.0,
        );
        self.supervision.observe(limits, wanted.deviation.abs(), is_limited)?;
        Ok(timing.between_two(limited))
    }
}
