//! The current controller at run time: in each instant, from a sample and a code to compare values, by the model of
//! each current, its feed-forward and its feedback (theory, sections 15.1 and 15.2).

use core::hint::cold_path;

use super::alignment::{Alignment, AlignmentStep, Field};
use super::current_loop::{CurrentLoop, Law};
use super::fault::PowerFault;
use super::modulation::{Duties, Rotation, Sample, Vector};
use super::phase::{IndexOffset, OffsetCheck, PhaseAlignment, Speed, Turn, check_index};
use super::supervision::{Offsets, Supervision, Surroundings};
use crate::encoder::RawCount;

/// A running current loop.
#[derive(Clone, Copy, Debug)]
pub struct CurrentController {
    design: CurrentLoop,
    offsets: Offsets,
    /// Supply and temperature before the gates are switched on.
    last: Option<Sample>,
    /// The offsets of the phases U and V in counts, stored at the last start.
    offset: [f32; 2],
    /// The current that makes torque; for a brushless motor also the current along its magnets.
    follower: Follower,
    along: Follower,
    turn: Turn,
    phase: Option<PhaseAlignment>,
    /// Whether the program states the phase, and no torque has shown yet that it is the motor's.
    is_unchecked: bool,
    /// The position of the first index since a restart, at which all others come.
    index: Option<Turn>,
    speed: Speed,
    supervision: Supervision,
    surroundings: Surroundings,
    /// Current in A of the last sample; zero while the gates are off.
    current: f32,
}

/// The motion of a brushless motor in the direction of its field.
#[derive(Clone, Copy)]
struct Moved {
    /// Counts since the last instant, and their mean over the last ones.
    counts: f32,
    mean: f32,
}

impl Moved {
    const NONE: Self = Self { counts: 0.0, mean: 0.0 };

    /// The motion by a step of the encoder.
    #[inline(always)]
    fn by(step: i32, phase: &PhaseAlignment, speed: &mut Speed) -> Self {
        let counts = phase.sign() * step as f32;
        Self { counts, mean: speed.update(counts) }
    }
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
            along: Follower::AT_REST,
            turn: design.turn,
            phase: None,
            is_unchecked: false,
            index: None,
            speed: Speed::new(design.counter),
            supervision: Supervision::NONE,
            surroundings: Surroundings::of(design.limits.bus.0),
            current: 0.0,
        }
    }

    /// Takes a sample while the gates are off: the counts without a current.
    pub fn measure_offset(&mut self, sample: &Sample) {
        self.offsets.measure(sample);
        self.move_to(sample.position);
        self.last = Some(*sample);
        self.current = 0.0;
    }

    /// Current in A of the last sample, with the sign of its torque; zero while the gates are off.
    pub const fn current(&self) -> f32 {
        self.current
    }

    /// Takes the count of the encoder's index, after the nearest sample. If the phase is unknown and the
    /// program states the phase at the index, the motor is aligned from here on.
    ///
    /// # Errors
    /// If the index is at another count than before, so that counts were lost: switch the gates off. The
    /// phase is then unknown, and the next index is a new reference.
    #[cold]
    pub fn observe_index(&mut self, captured: RawCount) -> Result<(), PowerFault> {
        let mut at = self.turn;
        at.move_by(self.speed.since_last(captured));
        if let Err(fault) = check_index(*self.index.get_or_insert(at), at) {
            (self.phase, self.index) = (None, None);
            return Err(fault);
        }
        if let (None, Some(offset)) = (self.phase, self.design.index_offset()) {
            (self.phase, self.is_unchecked) = (Some(offset.phase(at)), true);
        }
        Ok(())
    }

    /// The phase of the motor at the index, once both are known; a program may state it.
    pub fn index_offset(&self) -> Option<IndexOffset> {
        Some(IndexOffset::of(self.phase?, self.index?))
    }

    /// Stores the result of an alignment.
    pub const fn set_phase(&mut self, phase: PhaseAlignment) {
        (self.phase, self.is_unchecked) = (Some(phase), false);
    }

    /// The check of a phase that the program states, before its first torque; `None` if none is needed.
    pub fn start_offset_check(&self) -> Option<OffsetCheck> {
        self.is_unchecked.then(|| OffsetCheck::new(self.design.instant()))
    }

    /// One instant of that check; `None` at its end, if the phase is the motor's.
    ///
    /// # Errors
    /// Faults, after which the gates are to be switched off.
    #[cold]
    pub fn check_offset(
        &mut self,
        sample: &Sample,
        check: &mut OffsetCheck,
    ) -> Result<Option<Duties>, PowerFault> {
        let Some(phase) = self.phase else { return Err(self.not_aligned()) };
        let step = self.move_to(sample.position);
        let moved = Moved::by(step, &phase, &mut self.speed);
        let Some(current) = check.step(step) else {
            check.result()?;
            self.is_unchecked = false;
            return Ok(None);
        };
        let amps = self.design.law.full_scale();
        // Forward for the handle is backward for the magnets of a reversed motor.
        let wanted =
            Vector { along: amps * current.along, across: phase.sign() * amps * current.across };
        self.step_vector(sample, phase.angle(self.turn.angle()), wanted, moved).map(Some)
    }

    /// Prepares for gates that are switched on before the next instant, with no current and no voltage. The
    /// code must be that of zero torque.
    ///
    /// # Errors
    /// If the offsets, the supply or the temperature of the last sample are out of range, or a brushless
    /// motor is not aligned.
    pub fn start(&mut self) -> Result<(), PowerFault> {
        if self.design.is_brushless() && self.phase.is_none() {
            return Err(self.not_aligned());
        }
        self.start_at_rest()
    }

    /// The same for an alignment of a motor whose phase is unknown; only on request, because it moves the
    /// handle.
    ///
    /// # Errors
    /// If the offsets, the supply or the temperature of the last sample are out of range.
    pub fn start_alignment(&mut self) -> Result<Alignment, PowerFault> {
        self.start_at_rest()?;
        // Counts lost before do not affect this alignment.
        self.index = None;
        Ok(Alignment::new(&self.design, self.turn))
    }

    /// An instant in which all low sides conduct, before a start: checks the currents and the surroundings.
    ///
    /// # Errors
    /// Faults, after which the gates are to be switched off.
    #[cold]
    pub fn charge(&mut self, sample: &Sample) -> Result<(), PowerFault> {
        let limits = &self.design.limits;
        limits.check_currents(sample, self.offset)?;
        if self.design.is_brushless() {
            limits.check_third_current(sample, self.offset)?;
        }
        self.surroundings.observe(limits, sample)?;
        self.move_to(sample.position);
        self.last = Some(*sample);
        Ok(())
    }

    const fn not_aligned(&self) -> PowerFault {
        PowerFault::NotAligned { by_index: self.design.index_offset().is_some() }
    }

    fn start_at_rest(&mut self) -> Result<(), PowerFault> {
        self.offset = self.offsets.checked(&self.design.limits)?;
        if let Some(sample) = self.last {
            self.design.limits.check_surroundings(&sample)?;
            self.surroundings = Surroundings::of(sample.bus);
        }
        (self.follower, self.along) = (Follower::AT_REST, Follower::AT_REST);
        self.supervision = Supervision::NONE;
        self.speed.restart();
        Ok(())
    }

    /// One instant: returns the compare values for the next instant, for a code given by
    /// [`DacCode::offset`](crate::dac::DacCode::offset).
    ///
    /// # Errors
    /// Faults, after which the gates are to be switched off.
    #[inline(always)]
    pub fn step(&mut self, sample: &Sample, code_offset: i16) -> Result<Duties, PowerFault> {
        if self.design.is_brushless() {
            self.step_of::<true>(sample, code_offset)
        } else {
            self.step_of::<false>(sample, code_offset)
        }
    }

    /// The same with the kind of motor in the type, so that the program has no code for the other kind.
    ///
    /// # Errors
    /// As for [`CurrentController::step`].
    #[inline(always)]
    pub fn step_of<const BRUSHLESS: bool>(
        &mut self,
        sample: &Sample,
        code_offset: i16,
    ) -> Result<Duties, PowerFault> {
        if BRUSHLESS {
            self.step_brushless(sample, code_offset)
        } else {
            self.step_brushed(sample, code_offset)
        }
    }

    /// The fault of a comparator that has turned the gates off, with the largest of the currents of the
    /// next instant, and at least the limit of the current interrupt.
    #[cold]
    pub fn over_current(&self, sample: &Sample) -> PowerFault {
        let limits = &self.design.limits;
        let counts = |phase: usize| (f32::from(sample.currents[phase]) - self.offset[phase]).abs();
        let mut most = counts(0).max(counts(1)).max(limits.over_current.into());
        if self.design.is_brushless() {
            most = most.max(limits.third_current(sample, self.offset));
        }
        limits.over_current(most)
    }

    /// One instant of an alignment. At its end the phase is stored, if one was found.
    ///
    /// # Errors
    /// Faults, after which the gates are to be switched off.
    pub fn align(
        &mut self,
        sample: &Sample,
        alignment: &mut Alignment,
    ) -> Result<AlignmentStep, PowerFault> {
        let step = self.move_to(sample.position);
        let Some(Field { angle, current }) = alignment.step(step) else {
            let result = alignment.result();
            (self.phase, self.is_unchecked) = (result.ok(), false);
            return Ok(AlignmentStep::Ended(result));
        };
        let wanted = Vector { along: current * self.design.law.full_scale(), across: 0.0 };
        self.step_vector(sample, angle, wanted, Moved::NONE).map(AlignmentStep::Turning)
    }

    /// Counts since the last instant.
    #[inline(always)]
    const fn move_to(&mut self, position: RawCount) -> i32 {
        let step = self.speed.step(position);
        self.turn.move_by(step);
        step
    }

    /// The instant of a brushed motor.
    #[inline(always)]
    fn step_brushed(&mut self, sample: &Sample, code_offset: i16) -> Result<Duties, PowerFault> {
        let moved = self.speed.step(sample.position) as f32;
        let CurrentLoop { law, output, limits, timing, .. } = &self.design;
        limits.check_currents(sample, self.offset)?;
        let bus = self.surroundings.observe(limits, sample)?;
        let [u, v] = sample.currents.map(f32::from);
        let current = law.between_two((u - v) - (self.offset[0] - self.offset[1]));
        self.current = current;
        let reference = law.amps_per_code * f32::from(code_offset);
        let wanted = self.follower.follow(law, reference, current);
        // The supply changes from instant to instant: the only division.
        let counts = wanted.volts * (output.counts_per_volt / bus)
            + output.dead_time(self.follower.twice_mean());
        let span = f32::from(output.span);
        let limited = counts.clamp(-span, span);
        let is_limited = limited != counts;
        self.follower.integrate(
            law,
            wanted.deviation,
            is_limited && wanted.deviation * counts > 0.0,
        );
        let deviation = Vector { along: 0.0, across: wanted.deviation };
        self.supervision.observe(limits, deviation, moved, is_limited)?;
        Ok(timing.between_two(limited))
    }

    /// The instant of a brushless motor: the current across the magnets follows the code, the current along
    /// them zero.
    #[inline(always)]
    fn step_brushless(&mut self, sample: &Sample, code_offset: i16) -> Result<Duties, PowerFault> {
        let Some(phase) = self.phase else {
            cold_path();
            return Err(self.not_aligned());
        };
        let step = self.move_to(sample.position);
        let moved = Moved::by(step, &phase, &mut self.speed);
        let reference = phase.sign() * self.design.law.amps_per_code * f32::from(code_offset);
        let wanted = Vector { along: 0.0, across: reference };
        let duties = self.step_vector(sample, phase.angle(self.turn.angle()), wanted, moved);
        self.current *= phase.sign();
        duties
    }

    /// Controls the currents along and across an angle.
    #[inline(always)]
    fn step_vector(
        &mut self,
        sample: &Sample,
        angle: u32,
        reference: Vector,
        moved: Moved,
    ) -> Result<Duties, PowerFault> {
        let CurrentLoop { law, output, limits, timing, .. } = &self.design;
        limits.check_currents(sample, self.offset)?;
        limits.check_third_current(sample, self.offset)?;
        let bus = self.surroundings.observe(limits, sample)?;
        let [u, v] = sample.currents.map(f32::from);
        let amps = |count: f32, offset: f32| law.amps_per_count * (count - offset);
        let phases = Vector::of_two_phases(amps(u, self.offset[0]), amps(v, self.offset[1]));
        let rotation = Rotation::of(angle);
        let current = phases.seen_from(rotation);
        self.current = current.across;
        let across = self.follower.follow(law, reference.across, current.across);
        let along = self.along.follow(law, reference.along, current.along);
        let turned = law.radians * moved.mean;
        let volts = Vector {
            along: along.volts - 0.5 * turned * self.follower.volts_across(law),
            across: across.volts + 0.5 * turned * self.along.volts_across(law),
        };
        // The supply changes from instant to instant: the only division.
        let counts = volts.times(output.counts_per_volt / bus);
        let (limited, is_limited) = counts.within(output.circle);
        let goes_on = |wanted: Wanted, counts: f32| is_limited && wanted.deviation * counts > 0.0;
        self.follower.integrate(law, across.deviation, goes_on(across, counts.across));
        self.along.integrate(law, along.deviation, goes_on(along, counts.along));
        let deviation = Vector { along: along.deviation, across: across.deviation };
        self.supervision.observe(limits, deviation, moved.counts, is_limited)?;
        // From the sample to the middle of the period in which the voltage acts.
        let rotation = rotation.ahead(1.5 * turned);
        let model = Vector { along: self.along.twice_mean(), across: self.follower.twice_mean() };
        let (limited, model) = (limited.turned(rotation), model.turned(rotation));
        Ok(limited.duties(model.dead_time(output.dead), *timing))
    }
}

/// A current that follows its model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    /// The model's current in A at this instant, and at the next instant, whose voltage is already set.
    model: f32,
    next: f32,
    /// The integral part of the feedback.
    held: f32,
}

/// The requested voltage, and the deviation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Voltage in V. It does not include the motor's back-EMF, which the feedback compensates (theory,
    /// section 15.8).
    pub volts: f32,
    /// The model's current less the measured one, in A.
    pub deviation: f32,
}

impl Follower {
    /// No current and no voltage.
    pub(super) const AT_REST: Self = Self { model: 0.0, next: 0.0, held: 0.0 };

    /// Advances the model by an instant, independently of the available voltage, because it is the certified
    /// model. The voltage moves the current to the model.
    #[inline(always)]
    pub(super) const fn follow(&mut self, law: &Law, reference: f32, current: f32) -> Wanted {
        let deviation = self.model - current;
        let after_next = self.next + law.model_gain * (reference - self.next);
        let forward = (after_next - law.decay * self.next) * law.volts;
        let feedback = law.proportional * deviation + (self.held + law.integral * deviation);
        (self.model, self.next) = (self.next, after_next);
        Wanted { volts: forward + feedback, deviation }
    }

    /// The voltage across the model's current for each rad that the current turns from an instant to the
    /// middle of the next voltage. Call it after [`follow`](Self::follow).
    #[inline(always)]
    pub(super) const fn volts_across(&self, law: &Law) -> f32 {
        (self.next + law.decay * self.model) * law.volts
    }

    /// Twice the model's mean current while the voltage acts. Call it after [`follow`](Self::follow). It has
    /// no noise, so its sign does not flicker like that of a measured current.
    #[inline(always)]
    pub(super) const fn twice_mean(&self) -> f32 {
        self.model + self.next
    }

    /// Updates the integral, unless the voltage is limited and the integral would wind up.
    #[inline(always)]
    pub(super) const fn integrate(&mut self, law: &Law, deviation: f32, is_limited: bool) {
        if !is_limited {
            self.held += law.integral * deviation;
        }
    }
}
