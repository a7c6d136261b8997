//! A servo together with the mode that it was timed for, and what a cycle needs besides.

use core::hint::cold_path;
use core::marker::PhantomData;

use super::{Output, Servo};
use crate::build_error::BuildError;
use crate::certificate::{TimingChecked, timing_checked};
use crate::encoder::RawCount;
use crate::energy::{EnergyMonitor, Injector, NoAction};
use crate::environment::{Discretize, EnvironmentModel, SupportsTiming};
use crate::number::Number;
use crate::output_timing::{OutputMode, OutputTiming, READ_WITHIN};
use crate::scene::Scene;
use crate::transducers::Transducers;

/// Options of the rendering, apart from the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct RenderingOptions {
    /// Time in s in which the clamp opens from nothing to the torque limit, and closes; for another set
    /// of parameters a tenth of it ([`longest_gap`](crate::servo_loop::longest_gap)).
    pub fade: f64,
    /// Damping in N m s/rad that is injected while more energy has gone into the hand than came
    /// out of it; `None`: the energy is only watched.
    pub injection: Option<f64>,
}

impl RenderingOptions {
    /// Fades within a tenth of a second: too slow to feel as a step, and a short wait.
    /// Injects nothing.
    pub const DEFAULT: Self = Self { fade: 0.1, injection: None };
}

impl RenderingOptions {
    /// For constants: a compile error where the damping that is injected does not fit into the room
    /// that a scene leaves; see [`TimingChecked::injectable_damping`].
    ///
    /// # Panics
    /// If it does not; in a constant that is the compile error.
    #[track_caller]
    pub const fn checked_beside(&self, room: f64) {
        if let Some(damping) = self.injection {
            if let Err(error) = BuildError::unless_positive("injected damping", damping) {
                error.refuse();
            }
            if damping >= room {
                BuildError::Injection { damping, room }.refuse();
            }
        }
    }
}

impl Default for RenderingOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The servo of a scene that was timed for the mode `M`, ready to be swapped in.
#[derive(Clone, Debug)]
pub struct PreparedServo<E: Discretize<N>, N: Number, M> {
    servo: Servo<E, N>,
    injector: Option<Injector<N>>,
    pace: TimingLimits,
    mode: PhantomData<M>,
}

/// Limits on the time between updates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingLimits {
    /// The period in s.
    pub period: f64,
    /// Updates in a row that may be missed before the certificate is void.
    pub tolerated: u32,
    /// The worst period in periods.
    stretch: f32,
    /// The latest that a count may be read where its torque comes at a fixed phase, in periods after the
    /// beginning of its own.
    read_within: f32,
    /// The most counts that the encoder can move within a period.
    pub largest_step: u32,
    /// Twice that.
    span: u32,
}

impl<E, N: Number, M: OutputMode> PreparedServo<E, N, M>
where
    E: EnvironmentModel + Discretize<N> + SupportsTiming<M>,
{
    /// The servo of a timed scene, at rest at zero and with its clamp shut. The certificate is taken again
    /// in this number format: it may be of other coefficients, such as the scene's as it was written, or of
    /// a statement that is not what the environment states now.
    ///
    /// # Errors
    /// Where the scene, the transducers or the options cannot be had in this number format.
    pub fn new(
        timed: &TimingChecked<Scene<E>, M>,
        transducers: &Transducers,
        options: &RenderingOptions,
    ) -> Result<Self, BuildError> {
        let format = N::FORMAT;
        let again = timing_checked(*timed.scene(), format);
        let again = again.map_err(|_| BuildError::Uncertified { format })?;
        Self::build(&again, transducers, options)
    }
}

impl<E: Discretize<N>, N: Number, M: OutputMode> PreparedServo<E, N, M> {
    /// From a certificate in this number format.
    // Not inlined: its frame is off the stack while a scene is certified.
    #[inline(never)]
    pub(crate) fn build(
        timed: &TimingChecked<Scene<E>, M>,
        transducers: &Transducers,
        options: &RenderingOptions,
    ) -> Result<Self, BuildError> {
        let scene = timed.scene();
        let period = scene.timing.period;
        let bound = scene.torque_limit.unwrap_or(transducers.full_scale_torque);
        BuildError::unless_positive("time of fading", options.fade)?;
        let ticks = (options.fade / period).max(1.0);
        let mut servo = Servo::build(scene, transducers)?.fading(bound, ticks)?;
        servo.shut();
        if matches!(M::TIMING, OutputTiming::Latched) && !servo.is_late() {
            return Err(BuildError::NotLate);
        }
        let room = timed.injectable_damping();
        let injector = match options.injection {
            None => None,
            Some(damping) if damping < room => {
                let injector = Injector::new(damping, period)?;
                // Its gain may have been rounded up.
                if injector.damping(period) >= room {
                    return Err(BuildError::Injection { damping, room });
                }
                Some(injector)
            }
            Some(damping) => return Err(BuildError::Injection { damping, room }),
        };
        let pace = TimingLimits::new(scene, transducers)?;
        Ok(Self { servo, injector, pace, mode: PhantomData })
    }

    /// One tick: the code to be written now. A deficit of energy injects damping, if the
    /// options have it.
    #[inline(always)]
    pub fn tick(&mut self, raw: RawCount, energy: &EnergyMonitor) -> Output {
        let Some(injector) = &mut self.injector else {
            return self.servo.timed_tick::<M>(raw, &mut NoAction);
        };
        cold_path();
        injector.switch(energy.is_deficit());
        self.servo.timed_tick::<M>(raw, injector)
    }

    /// The servo.
    pub const fn servo(&self) -> &Servo<E, N> {
        &self.servo
    }

    /// The servo, for its clamp.
    pub(crate) const fn servo_mut(&mut self) -> &mut Servo<E, N> {
        &mut self.servo
    }

    /// Starts anew at the present position, with the clamp shut: as if the device had always been
    /// there.
    pub(crate) fn rest_here(&mut self) {
        let x = self.servo.rest_here();
        if let Some(injector) = &mut self.injector {
            injector.rest_at(x);
        }
    }

    /// Limits on the time between updates.
    pub const fn timing_limits(&self) -> TimingLimits {
        self.pace
    }
}

impl TimingLimits {
    /// Ticks up to which a wrapping counter of them distinguishes future from past.
    pub(crate) const LONGEST: u32 = i32::MAX.cast_unsigned();

    /// Whole periods in `time` s, at least one and at most [`LONGEST`](Self::LONGEST).
    pub(crate) fn ticks(&self, time: f64) -> u32 {
        // The cast saturates.
        ((time / self.period) as u32).clamp(1, Self::LONGEST)
    }

    /// The latest that a tick may begin, in periods after the beginning of its own, where torques are
    /// latched: `periods` after a tick that began `before` periods late.
    ///
    /// Between the two counts are `periods + late - before`, from the first of them to its latch
    /// `1 - before`, and the certificate allows the one to be a worst period over the period times the
    /// other. A tick in time counts as one at the beginning; half a period is late enough.
    pub(crate) fn latest(&self, periods: u32, before: f32) -> f32 {
        let in_time = (READ_WITHIN / self.period) as f32;
        let before = if before <= in_time { 0.0 } else { before };
        let allowed = self.stretch * (1.0 - before) + before - periods as f32;
        // A worst period of whole periods, but for rounding.
        if allowed < -1e-5 { 0.0 } else { allowed.max(in_time).min(0.5) }
    }

    /// The latest that a tick may begin, in periods after the beginning of its own, where torques come at a
    /// fixed phase: a count that is read late is nearer to its torque, by no more than the scene's jitter.
    pub(crate) const fn latest_at_phase(&self) -> f32 {
        self.read_within
    }

    /// Whether the encoder cannot have moved by `step` counts within a period.
    #[inline(always)]
    pub(crate) const fn is_too_far(&self, step: i32) -> bool {
        // Shifted so that one comparison sees both ends.
        step.cast_unsigned().wrapping_add(self.largest_step) > self.span
    }

    fn new<E>(scene: &Scene<E>, transducers: &Transducers) -> Result<Self, BuildError> {
        let timing = scene.timing;
        let worst = timing.worst_period.unwrap_or(timing.period);
        // A worst period of two periods, to the digits that were written, is two.
        let periods = worst / timing.period + 1e-9;
        let tolerated = (periods as u32).saturating_sub(1);
        // The counter must not wrap unseen before the missed ticks become a fault.
        transducers.largest_step(worst)?;
        let largest_step = transducers.largest_step(timing.period)?;
        // Below half the counter's range, so that twice that fits.
        let stretch = (worst / timing.period) as f32;
        let span = 2 * largest_step;
        let read_within = (scene.latency.output_jitter.max(READ_WITHIN) / timing.period) as f32;
        let period = timing.period;
        Ok(Self { period, tolerated, stretch, read_within, largest_step, span })
    }
}
