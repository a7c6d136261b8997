//! The checks at each instant; the measurements without a current before each start; and the limit of the torque by
//! the heat of the current.
//!
//! A comparator's offset, of up to 9 mV, is as much as the voltage of 5 A at its input. So the threshold is not
//! computed from the converters' counts, but found at the comparator itself: while the gates are low, it falls by
//! a code in each instant, over the whole range in which a working comparator trips.
//!
//! I2t takes the torque's limit down to the continuous current before the power stage gets too hot. The mean of the
//! squared current, over the time constant of a first-order lag, is the heat. From nine tenths of the continuous
//! current's heat on, the allowed current falls in a straight line, from full scale to the continuous current at its
//! own heat: there the two stay, because a current at its own heat does not change the heat. The servo's limit moves
//! by the steps of its clamp, and rises only above a torque that it did not limit.

use core::hint::cold_path;

use super::current_loop::{CurrentLoop, HeatLimit, Limits};
use super::fault::PowerFault;
use super::modulation::{Sample, Vector, larger};
use super::power_stage::TripRange;
use crate::dac::DacCode;

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
    /// of its torque, and whether the voltage was limited. An error if a deviation that no motion explains, or a
    /// limited voltage, has lasted too long.
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

    /// Takes a sample; returns the count of a supply in range, which is never 0. An error if one of the two was out
    /// of range in [`SAMPLES`] consecutive samples.
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

/// The number of samples in a mean, whose noise is a sixteenth of that of a sample.
const OFFSET_SAMPLES: u32 = 256;

/// The mean of the last whole block of samples, taken while the gates are off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offsets {
    sums: [u32; 2],
    samples: u32,
    /// Sums of the last whole block, so that they are the offsets with eight more bits.
    blocks: Option<[u32; 2]>,
}

impl Offsets {
    pub(super) const NONE: Self = Self { sums: [0; 2], samples: 0, blocks: None };

    pub(super) const fn measure(&mut self, sample: &Sample) {
        let [u, v] = self.sums;
        // No sum is above 2^24.
        self.sums = [u + sample.currents[0] as u32, v + sample.currents[1] as u32];
        self.samples += 1;
        if self.samples == OFFSET_SAMPLES {
            *self = Self { blocks: Some(self.sums), ..Self::NONE };
        }
    }

    /// The means in counts, which `f32` holds exactly; an error if one is not that of a working amplifier, or no block
    /// is complete.
    pub(super) fn checked(&self, limits: &Limits) -> Result<[f32; 2], PowerFault> {
        let sums = self.blocks.unwrap_or_default();
        let (lowest, highest) = (u32::from(limits.offsets.0), u32::from(limits.offsets.1));
        for (phase, sum) in (0..).zip(sums) {
            let count = sum / OFFSET_SAMPLES;
            if self.blocks.is_none() || count < lowest || count > highest {
                return Err(PowerFault::CurrentOffset { phase, count });
            }
        }
        Ok(sums.map(|sum| sum as f32 / OFFSET_SAMPLES as f32))
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

/// Time constant in s of the heat: chosen, not from a data sheet, so that twice the continuous current lasts a
/// second from cold.
pub(super) const HEAT_TIME: f64 = 4.0;

/// Parts of the continuous current's heat at which the limit begins to fall, below which it rises again, and below
/// which it has risen: the heat takes longer from one to the other than a servo's limit takes to open.
const FALLS: f32 = 0.9;
const RISES: f32 = 0.8;
const RISEN: f32 = 0.25;

/// A step of the servo's torque limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatStep {
    /// The limit falls by a step.
    Lower,
    /// The limit rises by a step.
    Raise,
}

/// The heat of a running current loop.
#[derive(Clone, Copy, Debug)]
pub struct Heating {
    limit: Option<HeatLimit>,
    mean_square: f32,
    /// Whether the limit may not have risen since it last fell.
    is_lowered: bool,
}

impl CurrentLoop {
    /// The heat of a cold power stage under this loop.
    pub const fn heating(&self) -> Heating {
        Heating { limit: self.heat, mean_square: 0.0, is_lowered: false }
    }
}

impl Heating {
    /// Takes the current in A of a period of the servo and its code by
    /// [`DacCode::offset`](crate::dac::DacCode::offset); returns the step of the torque limit, if one is due.
    #[inline(always)]
    pub fn observe(&mut self, current: f32, code_offset: i16) -> Option<HeatStep> {
        let limit = self.limit.as_ref()?;
        self.mean_square += (current * current - self.mean_square) * limit.weight;
        if self.mean_square < FALLS * limit.square && !self.is_lowered {
            return None;
        }
        Self::step(limit, self.mean_square, &mut self.is_lowered, code_offset)
    }

    #[cold]
    #[inline(never)]
    fn step(
        limit: &HeatLimit,
        mean_square: f32,
        is_lowered: &mut bool,
        code_offset: i16,
    ) -> Option<HeatStep> {
        let full = f32::from(DacCode::CODES_TO_FULL_SCALE);
        let left = (1.0 - mean_square / limit.square) / (1.0 - FALLS);
        let allowed = limit.codes + (full - limit.codes) * left.clamp(0.0, 1.0);
        if f32::from(code_offset).abs() > allowed {
            *is_lowered = true;
            Some(HeatStep::Lower)
        } else if mean_square < RISES * limit.square && *is_lowered {
            *is_lowered = mean_square > RISEN * limit.square;
            Some(HeatStep::Raise)
        } else {
            None
        }
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
