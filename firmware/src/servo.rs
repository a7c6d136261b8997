//! One tick: encoder count in, converter code out.

use core::f64::consts::TAU;
use core::fmt;

use crate::certificate::Certified;
use crate::coupling::Solver;
use crate::dac::{Dac, DacCode};
use crate::encoder::{CounterWidth, Encoder, Position, RawCount};
use crate::environment::{Law, Renderable, Setting};
use crate::number::{Number, OutOfRange};
use crate::scene::Scene;
use crate::torque::{LimitReason, Limiter};

/// The scales of what surrounds the servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transducers {
    /// Encoder counts a turn of the device's axis, after quadrature and gearing.
    pub counts_per_turn: f64,
    /// Bits after which the counter wraps.
    pub counter: CounterWidth,
    /// Torque of the motor on the device's axis in N m at the converter's largest code.
    pub full_scale_torque: f64,
}

impl Transducers {
    fn radians_per_count(&self) -> Result<f64, BuildError> {
        let counts = self.counts_per_turn;
        BuildError::unless_positive("counts per turn", counts)?;
        Ok(TAU / counts)
    }

    fn codes_per_torque(&self) -> Result<f64, BuildError> {
        let full_scale = self.full_scale_torque;
        BuildError::unless_positive("full-scale torque", full_scale)?;
        Ok(f64::from(DacCode::CODES_TO_FULL_SCALE) / full_scale)
    }
}

/// What a tick gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// What the converter shall hold.
    pub code: DacCode,
    /// Why this is less than the scene asked for.
    pub limit: LimitReason,
}

/// The servo of a certified scene, computing in the number format `N`.
///
/// ```
/// use firmware::encoder::{CounterWidth, RawCount};
/// use firmware::environment::DelayedSpring;
/// use firmware::scene::{Coupling, Device, Scene, Timing};
/// use firmware::servo::{Servo, Transducers};
///
/// let scene = Scene {
///     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
///     timing: Timing { period: 1e-3, worst_period: None },
///     coupling: Coupling::Spring { stiffness: 44.0 },
///     environment: DelayedSpring::<1> { stiffness: 22.0 },
///     torque_limit: None,
/// };
/// let transducers = Transducers {
///     counts_per_turn: 61_440.0,
///     counter: CounterWidth::Bits32,
///     full_scale_torque: 1.0,
/// };
/// let mut servo: Servo<_, f32> = Servo::new(&scene.certified(), &transducers)?;
/// assert_eq!(servo.tick(RawCount::from(100_u32)).code.get(), 2048); // one sample late
/// assert!(servo.tick(RawCount::from(100_u32)).code.get() < 2048); // pushes back
/// # Ok::<(), firmware::servo::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Servo<E: Renderable<N>, N: Number> {
    position: Position,
    angle_scale: N::Coefficient,
    law: E::Law,
    solver: Solver<N>,
    limiter: Limiter<N>,
    code_scale: N::Coefficient,
    torque: N,
    radians_per_count: f64,
}

impl<E: Renderable<N>, N: Number> Servo<E, N> {
    /// The servo of a certified scene, at rest at zero.
    ///
    /// # Errors
    /// Where the scene or the transducers cannot be had in this number format; see [`BuildError`].
    pub fn new(scene: &Certified<Scene<E>>, transducers: &Transducers) -> Result<Self, BuildError> {
        Self::build(scene.scene(), transducers)
    }

    /// The servo of a scene that somebody else has judged.
    pub(crate) fn build(scene: &Scene<E>, transducers: &Transducers) -> Result<Self, BuildError> {
        let radians_per_count = transducers.radians_per_count()?;
        let codes_per_torque = transducers.codes_per_torque()?;
        let law = scene.environment.law(&Setting::of(scene)?)?;
        Ok(Self {
            position: Position::new(transducers.counter),
            angle_scale: N::angle_scale(radians_per_count)
                .map_err(|reason| BuildError::Unrepresentable { name: "encoder step", reason })?,
            solver: Solver::new(scene.coupling, law.slopes())?,
            law,
            limiter: limiter(scene.torque_limit, transducers.full_scale_torque)?,
            code_scale: N::code_scale(codes_per_torque)
                .map_err(|reason| BuildError::Unrepresentable { name: "codes per N m", reason })?,
            torque: N::ZERO,
            radians_per_count,
        })
    }

    /// One tick. Angle, coupling and environment solved with the limited torque, converter code:
    /// no division, no allocation, and nothing that could panic.
    #[inline(always)]
    pub fn tick(&mut self, raw: RawCount) -> Output {
        let angle = N::angle(self.position.update(raw), self.angle_scale);
        let wanted = self.solver.torque(self.law.offer(angle.value));
        let standing_still = if angle.saturated { LimitReason::Angle } else { LimitReason::None };
        let (torque, limit) = self.limiter.limit(wanted, standing_still);
        self.law.advance(self.solver.environment_position(angle.value, torque));
        self.torque = torque;
        // The motor pushes against the coupling's deflection.
        let code = torque.codes_below(DacCode::MID_SCALE.get(), self.code_scale);
        Output { code: DacCode::from_low_bits(code), limit }
    }

    /// One tick between an encoder and a converter that are at hand.
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

    /// Angle of the device in rad.
    pub fn angle_rad(&self) -> f64 {
        self.position.count() as f64 * self.radians_per_count
    }

    /// Coupling torque `F` of the last tick in N m; the motor applies `-F`.
    pub fn torque_nm(&self) -> f64 {
        self.torque.to_f64()
    }
}

fn limiter<N: Number>(limit: Option<f64>, full_scale: f64) -> Result<Limiter<N>, BuildError> {
    let (bound, reason) = match limit {
        Some(limit) => (limit, LimitReason::Torque),
        None => (full_scale, LimitReason::Converter),
    };
    BuildError::unless_positive("torque limit", bound)?;
    if bound > full_scale {
        return Err(BuildError::TorqueLimit { limit: bound, full_scale });
    }
    let bound = N::from_f64(bound)
        .map_err(|reason| BuildError::Unrepresentable { name: "torque limit", reason })?;
    Ok(Limiter::new(bound, reason))
}

/// Why a certified scene cannot run with these transducers in this number format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BuildError {
    /// A scale, a period or a limit is zero, negative or not finite.
    NotPositive {
        /// What it is.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// The scene's torque limit is above what the converter can give.
    TorqueLimit {
        /// The scene's limit in N m.
        limit: f64,
        /// The torque at the converter's largest code in N m.
        full_scale: f64,
    },
    /// A constant of the scene does not fit the number format.
    Unrepresentable {
        /// What it is.
        name: &'static str,
        /// Value, bound and format.
        reason: OutOfRange,
    },
    /// The loop of coupling and environment has no solution, or more than one.
    IllPosed {
        /// `1 + f / K_vc` with the environment's slope `f`, out of contact.
        line: f64,
        /// The same in contact with a wall that can only push.
        contact: f64,
    },
    /// The environment is delayed by more samples than are stored.
    Delay {
        /// What was asked for.
        delay: usize,
        /// The most that there is.
        largest: usize,
    },
    /// A numerator of higher degree than its denominator, or a denominator that is zero.
    Improper {
        /// Degree of the numerator.
        numerator: usize,
        /// Degree of the denominator.
        denominator: usize,
    },
}

impl BuildError {
    /// Refuses what is not positive and finite.
    pub(crate) fn unless_positive(name: &'static str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotPositive { name, value })
        }
    }

    /// Rounds a coefficient, or says which one does not fit.
    pub(crate) fn coefficient<N: Number>(
        name: &'static str,
        value: f64,
    ) -> Result<N::Coefficient, Self> {
        N::coefficient(value).map_err(|reason| Self::Unrepresentable { name, reason })
    }

    /// Rounds an angle or a torque, or says which one does not fit.
    pub(crate) fn number<N: Number>(name: &'static str, value: f64) -> Result<N, Self> {
        N::from_f64(value).map_err(|reason| Self::Unrepresentable { name, reason })
    }
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive { name, value } => {
                write!(f, "the {name} must be positive and finite, and is {value}")
            }
            Self::TorqueLimit { limit, full_scale } => write!(
                f,
                "the torque limit of {limit} N m is above the converter's full scale of \
                 {full_scale} N m: lower it to that, or scale the amplifier up"
            ),
            Self::Unrepresentable { name, reason } => write!(f, "the {name}: {reason}"),
            Self::IllPosed { line, contact } => write!(
                f,
                "coupling and environment have no unique solution: the loop gain 1 + f / K is \
                 {line} out of contact and {contact} in contact, and must be positive; a stiffer \
                 coupling or a delayed environment has one"
            ),
            Self::Delay { delay, largest } => {
                write!(f, "a delay of {delay} samples is longer than the {largest} that are stored")
            }
            Self::Improper { numerator, denominator } => write!(
                f,
                "a numerator of degree {numerator} over a denominator of degree {denominator} \
                 needs samples from the future"
            ),
        }
    }
}

impl core::error::Error for BuildError {}
