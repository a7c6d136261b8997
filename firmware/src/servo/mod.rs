//! One tick: encoder count in, DAC code out.

mod clamp;
mod prepared_servo;

pub use prepared_servo::{PreparedServo, RenderingOptions, TimingLimits};

pub use crate::build_error::BuildError;
pub use crate::environment::{Delayed, SupportsTiming};
pub use crate::output_timing::{AtPhase, Latched, OutputMode, OutputTiming, Simultaneous};
pub use crate::step::Step;
pub use crate::transducers::Transducers;

use core::hint::cold_path;

use crate::certificate::{Certified, certify_scene};
use crate::coupling::{Response, Solver};
use crate::coupling_memory::CouplingMemory;
use crate::dac::{Dac, DacCode};
use crate::encoder::{Encoder, Position, RawCount};
use crate::energy::{Action, NoAction};
use crate::environment::{Compensation, EnvironmentModel, Law};
use crate::number::{Number, OutOfRange};
use crate::rendering::Rendering;
use crate::scene::Scene;
use crate::torque::{LimitReason, Limiter};

/// Result of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Code for the DAC.
    pub code: DacCode,
    /// The reason if this torque is limited.
    pub limit: LimitReason,
}

/// The servo of a certified scene, computing in the number format `N`.
///
/// ```
/// use haptic_servo::encoder::{CounterWidth, RawCount};
/// use haptic_servo::environment::Wall;
/// use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
/// use haptic_servo::servo::{Servo, Transducers};
///
/// let scene = Scene {
///     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
///     timing: Timing { period: 1e-3, worst_period: None },
///     coupling: Coupling::Spring { stiffness: 44.0 },
///     environment: Wall::spring(22.0, 1).alone(),
///     latency: Latency::NONE, torque_limit: None,
/// };
/// let transducers = Transducers {
///     counts_per_turn: 61_440.0,
///     counter: CounterWidth::Bits32,
///     full_scale_torque: 1.0,
///     largest_speed: 100.0,
/// };
/// let mut servo: Servo<_, f32> = Servo::new(&scene.certified(), &transducers)?;
/// assert_eq!(servo.tick(RawCount::from(100_u32)).code.get(), 2048); // one sample late
/// assert!(servo.tick(RawCount::from(100_u32)).code.get() < 2048); // pushes back
/// # Ok::<(), haptic_servo::servo::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Servo<E: Rendering<N>, N: Number> {
    position: Position,
    angle_scale: N::Coefficient,
    law: E::Law,
    memory: E::Memory,
    anticogging: E::Anticogging,
    solver: Solver<N>,
    limiter: Limiter<N>,
    code_scale: N::Coefficient,
    torque: N,
    radians_per_count: f64,
}

impl<E: EnvironmentModel + Rendering<N>, N: Number> Servo<E, N> {
    /// The servo of a certified scene, at rest at zero. The scene is certified again if its certificate is
    /// for coefficients other than those of this number format, for instance the unrounded ones, or for a
    /// statement that differs from the environment's present statement.
    ///
    /// # Errors
    /// If this number format cannot represent the scene or the transducers; see [`BuildError`].
    pub fn new(scene: &Certified<Scene<E>>, transducers: &Transducers) -> Result<Self, BuildError> {
        let format = N::FORMAT;
        let is_of_this = scene.assessment().format == format && scene.is_what_is_stated();
        if !is_of_this && certify_scene(*scene.scene(), format).is_err() {
            return Err(BuildError::Uncertified { format });
        }
        Self::build(scene.scene(), transducers)
    }
}

impl<E: Rendering<N>, N: Number> Servo<E, N> {
    /// The servo of a scene that the caller has certified.
    pub(crate) fn build(scene: &Scene<E>, transducers: &Transducers) -> Result<Self, BuildError> {
        let radians_per_count = transducers.radians_per_count()?;
        let codes_per_torque = transducers.codes_per_torque()?;
        scene.setting()?;
        let context = E::context(scene);
        let memory = E::Memory::of(&context)?;
        let mut law = scene.environment.law(&context)?;
        if let Some(turn) = law.turn() {
            turn.set_counts(transducers.counts_per_turn)?;
        }
        let hysteresis = law.hysteresis();
        if hysteresis <= radians_per_count {
            return Err(BuildError::Hysteresis { hysteresis, count: radians_per_count });
        }
        let compliance = scene.coupling.compliance(memory.compliance())?;
        let limiter = transducers.limiter(scene.torque_limit)?;
        let anticogging = scene.environment.anticogging();
        if let Some((anticogging, _)) = &anticogging {
            transducers.check_anticogging(anticogging, scene.torque_limit)?;
        }
        let anticogging = E::Anticogging::of(anticogging, &context, transducers.counts_per_turn)?;
        Ok(Self {
            position: Position::new(transducers.counter),
            angle_scale: N::angle_scale(radians_per_count)
                .map_err(|reason| BuildError::Unrepresentable { name: "encoder step", reason })?,
            solver: Solver::new(compliance, law.slopes())?,
            law,
            memory,
            anticogging,
            limiter,
            code_scale: N::code_scale(codes_per_torque)
                .map_err(|reason| BuildError::Unrepresentable { name: "codes per N m", reason })?,
            torque: N::ZERO,
            radians_per_count,
        })
    }

    /// Whether no torque depends on the position of its own tick.
    pub(crate) fn is_late(&self) -> bool {
        let slopes = self.law.slopes();
        slopes.line == 0.0 && slopes.wall == 0.0
    }

    /// One tick. Angle, coupling and environment solved with the limited torque, DAC code:
    /// no division, no allocation, and nothing that could panic.
    #[inline(always)]
    pub fn tick(&mut self, raw: RawCount) -> Output {
        self.tick_zero_delay(raw, &mut NoAction)
    }

    /// One tick in the mode `M`, with an action that adds a torque.
    #[inline(always)]
    pub(crate) fn timed_tick<M: OutputMode>(
        &mut self,
        raw: RawCount,
        action: &mut impl Action<N>,
    ) -> Output {
        match M::TIMING {
            OutputTiming::Simultaneous | OutputTiming::AtPhase(_) => {
                self.tick_zero_delay(raw, action)
            }
            OutputTiming::Latched => self.tick_latched(raw, action),
        }
    }

    /// The code of the same instant as the count.
    #[inline(always)]
    fn tick_zero_delay(&mut self, raw: RawCount, action: &mut impl Action<N>) -> Output {
        let (x, standing_still) = self.angle(raw, action);
        self.compensate(false);
        let x = x.minus(self.memory.deflection_after(self.torque));
        let offer = action.add_to(self.law.evaluate(x));
        let output = self.solve_to_code(offer, standing_still);
        self.update_environment(x, action);
        output
    }

    /// The code of the *next* tick, which does not depend on the next tick's count, since the environment is
    /// late by at least one sample: the same bits as [`Servo::tick_zero_delay`] would return in the tick
    /// after this one.
    #[inline(always)]
    fn tick_latched(&mut self, raw: RawCount, action: &mut impl Action<N>) -> Output {
        let (x, standing_still) = self.angle(raw, action);
        self.compensate(true);
        let x = x.minus(self.memory.lasting_deflection());
        // The previous tick computed the torque of this tick.
        self.memory.remember(self.torque);
        self.update_environment(x, action);
        let offer = action.add_to(self.law.evaluate(x));
        self.solve_to_code(offer, standing_still)
    }

    /// One tick at an angle in rad without the encoder's rounding. Returns the torque in N m, with the error
    /// of the number format alone. For the host.
    ///
    /// # Errors
    /// If the format cannot represent the angle.
    pub fn tick_at(&mut self, angle: f64) -> Result<f64, OutOfRange> {
        self.anticogging.tick_at(angle, &self.limiter);
        let angle = self.law.turn().map_or(angle, |turn| turn.wrapped(angle));
        let x = N::from_f64(angle)?;
        let x = x.minus(self.memory.deflection_after(self.torque));
        self.solve_to_code(self.law.evaluate(x), LimitReason::None);
        self.update_environment(x, &mut NoAction);
        Ok(self.torque_nm())
    }

    /// The torque against the cogging at this tick's count, of which the coupling knows nothing.
    #[inline(always)]
    fn compensate(&mut self, latched: bool) {
        let count = self.position.low();
        self.anticogging.tick(count, self.angle_scale, latched, &self.limiter);
    }

    /// Ends the tick with the device at `x` (rad), less the lasting deflection, under this tick's torque.
    #[inline(always)]
    fn update_environment(&mut self, x: N, action: &mut impl Action<N>) {
        let x_e = self.solver.environment_position(x, self.torque);
        self.law.update(x_e);
        action.update(x_e);
    }

    /// The device's angle in rad, and the reason if it is held at the end of its range.
    #[inline(always)]
    fn angle(&mut self, raw: RawCount, action: &mut impl Action<N>) -> (N, LimitReason) {
        self.position.follow(raw);
        if let Some(turn) = self.law.turn()
            && let Some((count, turns)) = turn.within(self.position.low())
        {
            if turns != 0 {
                cold_path();
                let by = turn.left(turns);
                self.law.shift(by);
                action.shift(by);
            }
            return self.angle_of(count);
        }
        let reading = self.position.reading();
        if reading.saturated {
            cold_path();
            return (self.angle_of(reading.count).0, LimitReason::Angle);
        }
        self.angle_of(reading.count)
    }

    #[inline(always)]
    fn angle_of(&self, count: i32) -> (N, LimitReason) {
        let (x, fits) = N::angle(count, self.angle_scale);
        (x, if fits { LimitReason::None } else { LimitReason::Angle })
    }

    /// Solves coupling and environment with the limited torque, and keeps it as this tick's torque.
    #[inline(always)]
    fn solve_to_code(&mut self, offer: Response<N>, standing_still: LimitReason) -> Output {
        let (torque, limit) = self.limited(offer, standing_still);
        self.torque = torque;
        // The motor pushes against the coupling's deflection.
        let torque = self.anticogging.add_to(torque);
        let code = torque.codes_below(DacCode::MID_SCALE.get(), self.code_scale);
        Output { code: DacCode::from_low_bits(code), limit }
    }

    /// The torque of coupling and environment within its limit, and the reason if it was limited;
    /// `otherwise` if not.
    #[inline(always)]
    fn limited(&self, offer: Response<N>, otherwise: LimitReason) -> (N, LimitReason) {
        match offer {
            Response::Wall(wall) if E::Memory::IS_COMPLIANT || !self.solver.is_rigid() => {
                let wanted = self.solver.wall_or_face(wall.torque, wall.depth);
                self.limiter.limit_push(wanted, otherwise)
            }
            _ => self.limiter.limit(self.solver.torque(offer), otherwise),
        }
    }

    /// One tick with this encoder and this DAC.
    #[inline(always)]
    pub fn update(&mut self, encoder: &mut impl Encoder, dac: &mut impl Dac) -> LimitReason {
        let output = self.tick(encoder.read());
        dac.write(output.code);
        output.limit
    }

    /// Position in counts.
    pub const fn count(&self) -> i64 {
        self.position.count()
    }

    /// The position's low 32 bits; differences of it are steps.
    #[inline(always)]
    pub(crate) const fn low_count(&self) -> i32 {
        self.position.low()
    }

    /// Begins at a reading of an absolute encoder, before the first tick.
    pub(crate) const fn begin_at(&mut self, raw: RawCount) {
        self.position.follow(raw);
    }

    /// Counts from the position to the position of the next reading.
    pub(crate) fn step_to(&self, raw: RawCount) -> i32 {
        let mut next = self.position;
        next.update(raw);
        next.low().wrapping_sub(self.position.low())
    }

    /// Angle of the device in rad.
    pub fn angle_rad(&self) -> f64 {
        self.position.count() as f64 * self.radians_per_count
    }

    /// Coupling torque `F` of the last tick in N m, with what opposes the cogging; the motor applies `-F`.
    pub fn torque_nm(&self) -> f64 {
        self.anticogging.add_to(self.torque).to_f64()
    }
}

#[cfg(test)]
mod tests;
