//! The checks at each instant.

use core::hint::cold_path;

use super::current_loop::Limits;
use super::fault::PowerFault;
use super::modulation::Sample;
use super::vector::{Vector, larger};

/// Consecutive samples out of range that are a fault: noise of the bridge's edges affects one sample, and a
/// supply out of its range switches the gates off within three periods of the modulation.
const SAMPLES: u8 = 2;

/// The duration of a deviation or of a limited voltage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Supervision {
    limited: u16,
    /// Instants of the present run of deviations.
    deviating: u32,
    /// The sum of its deviations in A, plus what the speed before it makes.
    sum: f32,
    /// What a change of the speed from rest to the present one makes of such a sum, in A; the speed is smoothed as
    /// the winding smooths the current of a voltage.
    by_speed: f32,
}

impl Supervision {
    /// No deviation and no limited voltage, at rest.
    pub(super) const NONE: Self = Self { limited: 0, deviating: 0, sum: 0.0, by_speed: 0.0 };

    /// Takes an instant's deviation in A, the counts that the motor moved since the last instant in the direction
    /// of its torque, and whether the voltage was limited.
    ///
    /// # Errors
    /// If a deviation that no motion explains, or a limited voltage, has lasted too long.
    #[inline(always)]
    pub(super) fn observe(
        &mut self,
        limits: &Limits,
        deviation: Vector,
        moved: f32,
        is_limited: bool,
    ) -> Result<(), PowerFault> {
        self.limited = if is_limited { self.limited + 1 } else { 0 };
        if self.limited > limits.instants {
            cold_path();
            let (instants, allowed) = (self.limited.into(), limits.instants.into());
            return Err(PowerFault::SaturatedDuty { instants, allowed });
        }
        self.by_speed += limits.smoothing * (limits.amps_of_motion * moved - self.by_speed);
        let Vector { along, across } = deviation;
        let largest = larger(along.abs(), across.abs());
        if largest <= limits.deviation {
            (self.deviating, self.sum) = (0, self.by_speed);
            return Ok(());
        }
        self.deviating = self.deviating.wrapping_add(1);
        self.sum += across;
        if self.deviating > u32::from(limits.instants) {
            return self.explain(limits, along, largest);
        }
        Ok(())
    }

    /// Whether the motion explains a long run of deviations: only those across the field, and of their sum what
    /// the change of the speed makes (theory, section 15.10).
    #[cold]
    fn explain(&self, limits: &Limits, along: f32, deviation: f32) -> Result<(), PowerFault> {
        let unexplained = (self.sum - self.by_speed).abs();
        if unexplained <= limits.unexplained && along.abs() <= limits.deviation {
            return Ok(());
        }
        Err(PowerFault::CurrentNotFollowing {
            deviation: (deviation * 1e3) as u32,
            largest: (limits.deviation * 1e3) as u32,
        })
    }
}

/// Supply and temperature of the last samples; a single sample out of range is not a fault.
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

impl Limits {
    /// Checks that no phase has an over-current, with these offsets in counts.
    #[inline(always)]
    pub(super) fn check_currents(
        &self,
        sample: &Sample,
        offset: [f32; 2],
    ) -> Result<(), PowerFault> {
        let over_current = f32::from(self.over_current);
        for (count, offset) in sample.currents.into_iter().zip(offset) {
            let counts = (f32::from(count) - offset).abs();
            if counts > over_current {
                cold_path();
                return Err(self.over_current(counts));
            }
        }
        Ok(())
    }

    /// Checks the current of phase W, which no converter samples: the currents of a winding in a star add up
    /// to zero.
    #[inline(always)]
    pub(super) fn check_third_current(
        &self,
        sample: &Sample,
        offset: [f32; 2],
    ) -> Result<(), PowerFault> {
        let counts = self.third_current(sample, offset);
        if counts > f32::from(self.over_current) {
            cold_path();
            return Err(self.over_current(counts));
        }
        Ok(())
    }

    /// Current of phase W in counts, without its sign.
    #[inline(always)]
    pub(super) fn third_current(&self, sample: &Sample, offset: [f32; 2]) -> f32 {
        let [u, v] = sample.currents.map(f32::from);
        ((u + v) - (offset[0] + offset[1])).abs()
    }

    /// Checks that the supply and the temperature are in their range. A thermistor that is open reads as very
    /// cold, and a shorted one as very hot.
    #[inline(always)]
    pub(super) fn check_surroundings(&self, sample: &Sample) -> Result<(), PowerFault> {
        let is_good = sample.bus >= self.bus.0
            && sample.bus <= self.bus.1
            && sample.temperature >= self.thermistor.lowest()
            && sample.temperature <= self.temperature;
        if is_good {
            return Ok(());
        }
        cold_path();
        Err(self.surroundings(sample))
    }

    #[cold]
    #[inline(never)]
    pub(super) fn over_current(&self, counts: f32) -> PowerFault {
        let milliamps = |counts: f32| (counts * self.milliamps_per_count) as u32;
        PowerFault::OverCurrent {
            current: milliamps(counts),
            largest: milliamps(self.over_current.into()),
        }
    }

    #[cold]
    #[inline(never)]
    fn surroundings(&self, sample: &Sample) -> PowerFault {
        let millivolts = |count: u16| (f32::from(count) * self.millivolts_per_count) as u32;
        let voltage = millivolts(sample.bus);
        if sample.bus < self.bus.0 {
            return PowerFault::UnderVoltage { voltage, lowest: millivolts(self.bus.0) };
        }
        if sample.bus > self.bus.1 {
            return PowerFault::OverVoltage { voltage, highest: millivolts(self.bus.1) };
        }
        let (count, lowest, highest) =
            (sample.temperature, self.thermistor.lowest(), self.thermistor.highest());
        if count < lowest || count > highest {
            let (count, limit) = (count.into(), if count < lowest { lowest } else { highest });
            return PowerFault::Thermistor { count, limit: limit.into() };
        }
        PowerFault::OverTemperature {
            temperature: self.thermistor.tenths(sample.temperature),
            largest: self.thermistor.tenths(self.temperature),
        }
    }
}
