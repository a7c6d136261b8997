//! A servo with its output mode and the other data of the servo loop.

use core::hint::cold_path;
use core::marker::PhantomData;

use super::{Output, Servo};
use crate::build_error::BuildError;
use crate::certificate::{TimingChecked, timing_checked};
use crate::encoder::RawCount;
use crate::encoder_reading::EncoderReading;
use crate::energy::{EnergyMonitor, Injector, NoAction};
use crate::environment::{EnvironmentModel, SupportsTiming};
use crate::host::BesideServo;
use crate::number::Number;
use crate::output_timing::{OutputMode, OutputTiming, READ_WITHIN};
use crate::rendering::Rendering;
use crate::scene::Scene;
use crate::transducers::Transducers;

/// Options of the rendering, apart from the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct RenderingOptions {
    /// Time in s in which the clamp opens from zero to the torque limit, and closes; a swap of parameters
    /// takes a tenth of it for each ([`longest_gap`](crate::servo_loop::longest_gap)).
    pub fade: f64,
    /// Damping in N m s/rad that is injected while the net energy into the hand is positive; `None`: the
    /// energy is only monitored.
    pub injection: Option<f64>,
    /// Largest energy in J that a push may return to the supply of a board's own bridge (theory, section 17);
    /// `None`: the supply takes all of it, or a DAC drives the motor. `scene_program!` takes it from the
    /// current loop.
    pub returned: Option<f64>,
}

impl RenderingOptions {
    /// Fades within a tenth of a second: too slow to feel like a step, and a short wait. Injects no damping.
    pub const DEFAULT: Self = Self { fade: 0.1, injection: None, returned: None };
}

impl RenderingOptions {
    /// For constants: a compile error if the injected damping is more than the scene allows; see
    /// [`TimingChecked::injectable_damping`].
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

/// The servo of a scene that was checked for the timing of mode `M`, ready to be swapped in.
#[derive(Clone, Debug)]
pub struct PreparedServo<E: Rendering<N>, N: Number, M> {
    servo: Servo<E, N>,
    injector: Option<Injector<N>>,
    pace: TimingLimits,
    host: E::Host,
    mode: PhantomData<M>,
}

/// Limits on the time between updates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingLimits {
    /// The period in s.
    pub period: f64,
    /// Consecutive updates that may be missed under the certificate.
    pub tolerated: u32,
    /// The worst period in periods.
    stretch: f32,
    /// With a fixed phase, the latest time to read a count, in periods after the beginning of its period.
    read_within: f32,
    /// The largest step of the encoder within a period, in counts.
    pub largest_step: u32,
    /// Twice `largest_step`.
    span: u32,
}

impl<E, N: Number, M: OutputMode> PreparedServo<E, N, M>
where
    E: EnvironmentModel + Rendering<N> + SupportsTiming<M>,
{
    /// The servo of a timed scene, at rest at zero and with its clamp shut. The scene is certified again in
    /// this number format: its certificate may be for other coefficients, for instance the unrounded ones, or
    /// for a statement that differs from the environment's present statement.
    ///
    /// # Errors
    /// If this number format cannot represent the scene, the transducers or the options.
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

impl<E: Rendering<N>, N: Number, M: OutputMode> PreparedServo<E, N, M> {
    /// From a certificate in this number format.
    // Not inlined, so that its frame is not on the stack while a scene is certified.
    #[inline(never)]
    pub(crate) fn build(
        timed: &TimingChecked<Scene<E>, M>,
        transducers: &Transducers,
        options: &RenderingOptions,
    ) -> Result<Self, BuildError>
    where
        E: EnvironmentModel,
    {
        let scene = timed.scene();
        let period = scene.timing.period;
        let bound = scene.torque_limit.unwrap_or(transducers.full_scale_torque);
        BuildError::unless_positive("time of fading", options.fade)?;
        let ticks = (options.fade / period).max(1.0);
        let mut servo = Servo::build(scene, transducers)?.fading(bound, ticks)?;
        servo.clamp().shut();
        if matches!(M::TIMING, OutputTiming::Latched) && !servo.is_late() {
            return Err(BuildError::NotLate);
        }
        let room = timed.injectable_damping();
        let injector = match options.injection {
            None => None,
            Some(damping) if damping < room => {
                let injector = Injector::new(damping, period)?;
                // The gain may have been rounded up.
                if injector.damping(period) >= room {
                    return Err(BuildError::Injection { damping, room });
                }
                Some(injector)
            }
            Some(damping) => return Err(BuildError::Injection { damping, room }),
        };
        let pace = TimingLimits::new(scene, transducers)?;
        Ok(Self { servo, injector, pace, host: E::Host::silent(), mode: PhantomData })
    }

    /// The same servo with this host in place of a silent one.
    pub(crate) fn with_host(self, host: E::Host) -> Self {
        Self { host, ..self }
    }

    /// One tick: returns the code to be written now. During a deficit of energy it injects damping if the
    /// options request it.
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

    pub(crate) const fn servo_mut(&mut self) -> &mut Servo<E, N> {
        &mut self.servo
    }

    /// The host beside the servo.
    pub const fn host(&self) -> &E::Host {
        &self.host
    }

    pub(crate) const fn host_mut(&mut self) -> &mut E::Host {
        &mut self.host
    }

    /// Resets the servo at the present position with the clamp shut, as if the device had always been there.
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
    /// The longest interval in ticks for which a wrapping counter distinguishes future from past.
    pub(crate) const LONGEST: u32 = i32::MAX.cast_unsigned();

    /// Whole periods in `time` s, at least one and at most [`LONGEST`](Self::LONGEST).
    pub(crate) fn ticks(&self, time: f64) -> u32 {
        // The cast saturates.
        ((time / self.period) as u32).clamp(1, Self::LONGEST)
    }

    /// With latched torques, the latest beginning of a tick, in periods after the beginning of its period:
    /// `periods` after a tick that began `before` periods late.
    ///
    /// The time between the two counts is `periods + late - before`, and from the first count to its latch
    /// `1 - before`. The certificate allows the first time to be at most the second times the worst period
    /// over the period. A tick in time counts as if it began at the beginning; half a period late is the
    /// limit.
    pub(crate) fn latest(&self, periods: u32, before: f32) -> f32 {
        let in_time = (READ_WITHIN / self.period) as f32;
        let before = if before <= in_time { 0.0 } else { before };
        let allowed = self.stretch * (1.0 - before) + before - periods as f32;
        // A worst period of whole periods, except for rounding.
        if allowed < -1e-5 { 0.0 } else { allowed.max(in_time).min(0.5) }
    }

    /// With a fixed phase, the latest beginning of a tick, in periods after the beginning of its period: a
    /// late count is nearer to its torque, and the scene's jitter limits that.
    pub(crate) const fn latest_at_phase(&self) -> f32 {
        self.read_within
    }

    /// Whether `step` counts are too many for one period.
    #[inline(always)]
    pub(crate) const fn is_too_far(&self, step: i32) -> bool {
        // Shifted so that one comparison checks both bounds.
        step.cast_unsigned().wrapping_add(self.largest_step) > self.span
    }

    fn new<E: EnvironmentModel>(
        scene: &Scene<E>,
        transducers: &Transducers,
    ) -> Result<Self, BuildError> {
        let timing = scene.timing;
        let worst = timing.worst_period.unwrap_or(timing.period);
        // A worst period of two periods, within the precision of its digits, is two.
        let periods = worst / timing.period + 1e-9;
        let tolerated = (periods as u32).saturating_sub(1);
        // The counter must not wrap undetected before the missed ticks become a fault.
        let ideal = EncoderReading::ideal();
        let reading = if E::MAY_MISREAD { scene.latency.encoder } else { ideal };
        transducers.largest_step(worst, reading)?;
        let largest_step = transducers.largest_step(timing.period, reading)?;
        // Below half the counter's range, so that twice the value fits.
        let stretch = (worst / timing.period) as f32;
        let span = 2 * largest_step;
        let read_within =
            (scene.latency.deviation_of_counts().max(READ_WITHIN) / timing.period) as f32;
        let period = timing.period;
        Ok(Self { period, tolerated, stretch, read_within, largest_step, span })
    }
}
