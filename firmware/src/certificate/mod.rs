//! Turns a [`Scene`] into a [`Certified`] scene, or into a [`Rejection`] with the reason.
//!
//! At compile time and on the host the whole result is computed: the index, the obstacle, and the remedies. A
//! board limits every torque. At its start, and for every change that arrives over the wire, it only computes
//! the verdict ([`timing_checked`]), with the same functions.
//!
//! ```
//! use haptic_servo::certificate::Certified;
//! use haptic_servo::environment::Wall;
//! use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
//!
//! const WALL: Scene = Scene {
//!     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
//!     timing: Timing { period: 0.001, worst_period: None },
//!     coupling: Coupling::Spring { stiffness: 44.0 },
//!     environment: Wall::damped(22.0, 0.01, 1).alone(),
//!     latency: Latency::NONE, torque_limit: None,
//! };
//! // A constant that would not pass stops the compiler here, with the sentence below.
//! const CERTIFIED: Certified<Scene> = WALL.certified();
//! let alpha = CERTIFIED.assessment().alpha.unwrap();
//! assert!(alpha.contains(0.021) && alpha.hi() < 0.022);
//!
//! let stiffer = Scene { environment: Wall::damped(25.0, 0.01, 1).alone(), ..WALL };
//! let rejection = stiffer.certify().unwrap_err();
//! assert_eq!(rejection.reason(), "shortage");
//! assert!(rejection.to_string().contains("it would pass with stiffness <= 23.9 N m/rad"));
//! ```

mod anticogging;
mod assessment;
mod assumption;
mod between;
mod deviation;
pub(crate) mod digits;
mod endless;
mod inl;
mod linearity;
mod loop_intervals;
mod margin;
mod model;
mod modes;
mod part;
mod port;
mod problem;
mod profile;
mod quantization;
mod rejection;
mod remedy;
mod remedy_search;
mod rules;
mod scene_intervals;
mod secant;
mod static_law;
mod timed;
mod validity;
mod varied;
mod window;

pub use anticogging::passivity_for_anticogging;
pub(crate) use anticogging::passivity_left;
pub use assessment::{Assessment, assess, assess_in};
pub use assumption::{Assumption, AssumptionStatus, Assumptions};
pub use linearity::is_static_at_port;
pub use model::LoopTransfers;
pub use modes::{RefusedMode, first_refused_mode};
pub use port::KeptResponses;
pub use problem::PassivityProblem;
pub use quantization::{QuantizationBound, Resolution};
pub use rejection::Rejection;
pub use remedy::{Remedies, Remedy};
pub use rules::{Rule, RuleAnswer, gamma};
pub use timed::{TimingChecked, TimingError};
pub use validity::InvalidParameter;

pub use crate::parameter::Parameter;

pub use crate::text::Sentence;

use crate::environment::*;
use crate::number::Format;
use crate::output_timing::OutputMode;
use crate::scene::Scene;
use crate::step::Step;
use assessment::{Extent, assessed};
use modes::tightest_mode;

/// A scene that was proved passive.
///
/// Only `certify` makes one, and a servo is only built from one: unchecked parameters cannot drive the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certified<S> {
    scene: S,
    data: Scene,
    assessment: Assessment,
}

impl<S> Certified<S> {
    /// The scene that was certified.
    pub const fn scene(&self) -> &S {
        &self.scene
    }

    /// The certified scene as data.
    pub const fn as_data(&self) -> &Scene {
        &self.data
    }

    /// The numbers of the certificate.
    pub const fn assessment(&self) -> &Assessment {
        &self.assessment
    }
}

impl Certified<Scene> {
    /// The same certificate of the scene with its environment in another type.
    pub(crate) const fn with_environment<E>(self, environment: E) -> Certified<Scene<E>> {
        let Self { scene, data, assessment } = self;
        Certified { scene: scene.in_environment(environment), data, assessment }
    }
}

/// Judges a scene given as data, with unrounded coefficients: the certificate's numbers, or the rejection.
pub const fn certify(scene: &Scene) -> Result<Assessment, Rejection> {
    certify_in(scene, Format::F64)
}

/// The same with the coefficients rounded to this number format.
pub const fn certify_in(scene: &Scene, format: Format) -> Result<Assessment, Rejection> {
    let assessment = assessed(scene, format, Extent::OwnRule);
    match assessment.outcome {
        Ok(()) => Ok(assessment),
        Err(rejection) => Err(remedy_search::with_remedies(rejection, scene, format)),
    }
}

/// Panics with the rejection's text, which names the mode if another mode is selected.
#[track_caller]
const fn refuse_scene(data: &Scene, rejection: &Rejection, format: Format) -> ! {
    match first_refused_mode(data, format) {
        Some(refused) => refused.sentence_in(format).refuse(),
        None => rejection.sentence_in(format).refuse(),
    }
}

impl<E: Copy> Scene<E> {
    const fn judged(self, data: Scene, format: Format) -> Result<Certified<Self>, Rejection> {
        if let Some(RefusedMode { reason, .. }) = first_refused_mode(&data, format) {
            return Err(reason);
        }
        let assessment = ok!(certify_in(&data, format));
        Ok(Certified { scene: self, data, assessment })
    }
}

impl<E: StatedEnvironment> Scene<E> {
    /// Judges the scene of an environment of another crate with this statement. For constants; for a scene at
    /// run time, [`certify_scene`] calls the environment.
    ///
    /// # Errors
    /// The reason why the scene is not certified.
    pub const fn certify_as(self, stated: StatedModel) -> Result<Certified<Self>, Rejection> {
        self.judged(self.in_environment(Environment::Stated(stated)), Format::F64)
    }

    /// For constants: the certified scene of an environment of another crate, or a compile error with the
    /// reason.
    ///
    /// # Panics
    /// If the scene is not certified; in a constant this is a compile error.
    #[track_caller]
    pub const fn certified_as(self, stated: StatedModel) -> Certified<Self> {
        match self.certify_as(stated) {
            Ok(certified) => certified,
            Err(rejection) => rejection.refuse(),
        }
    }
}

/// The scene with its environment, of any type, as data.
pub fn scene_data<E: EnvironmentModel>(scene: &Scene<E>) -> Scene {
    scene.in_environment(scene.environment.as_data(&scene.context()))
}

/// Certifies the coefficients rounded to a number format, for any type of environment.
///
/// # Errors
/// The reason for the rejection, and remedies.
pub fn certify_scene<E: EnvironmentModel>(
    scene: Scene<E>,
    format: Format,
) -> Result<Certified<Scene<E>>, Rejection> {
    scene.judged(scene_data(&scene), format)
}

/// The scene with its timing checked, if a board may render it: the verdict of [`certify_scene`] and
/// then [`Certified::time`] at a fraction of the cost, without numbers and remedies, which a
/// board's host computes.
///
/// # Errors
/// [`Step::Certificate`] if no board may render it.
pub fn timing_checked<E: EnvironmentModel + SupportsTiming<M>, M: OutputMode>(
    scene: Scene<E>,
    format: Format,
) -> Result<TimingChecked<Scene<E>, M>, Step> {
    let data = scene_data(&scene);
    // Checked here, because the type is known here.
    let is_late = is_late::<E>(&data.environment);
    timed::judged::<E, M>(&data, is_late, format)
        .map(|limited| TimingChecked::new(scene, format, limited))
}

impl<E: EnvironmentModel> Certified<Scene<E>> {
    /// Whether the certified statement equals the environment's present statement: always, except for a
    /// constant of an environment of another crate that was certified with another statement.
    pub fn is_what_is_stated(&self) -> bool {
        scene_data(&self.scene) == self.data
    }
}

impl<E: Copy> Certified<Scene<E>> {
    /// For constants: the same scene's certificate in the number format in which it runs, or a compile error
    /// with the reason.
    ///
    /// # Panics
    /// If the coefficients rounded to the format are not certified; in a constant this is a compile error.
    #[track_caller]
    pub const fn certified_in(self, format: Format) -> Self {
        match self.scene.judged(self.data, format) {
            Ok(certified) => certified,
            Err(rejection) => refuse_scene(&self.data, &rejection, format),
        }
    }

    /// Pairs the scene with the mode in which a board puts its torques out.
    ///
    /// # Errors
    /// If they do not agree; see [`TimingError`].
    pub const fn time<M: OutputMode>(self) -> Result<TimingChecked<Scene<E>, M>, TimingError>
    where
        E: SupportsTiming<M> + EnvironmentModel,
    {
        let is_rigid = matches!(self.scene.coupling, crate::coupling::Coupling::Rigid);
        if is_rigid && !E::MEMORY.may_be_uncoupled() {
            return Err(TimingError::Coupled);
        }
        let format = self.assessment.format;
        let of_modes = match tightest_mode(&self.data, format, M::TIMING) {
            Ok(of_modes) => of_modes,
            Err(RefusedMode { reason, .. }) => return Err(reason),
        };
        let own = ok!(timed::agree(M::TIMING, &self.data, format));
        let limited = or!(of_modes, own);
        Ok(TimingChecked::new(self.scene, format, limited))
    }

    /// For constants: the timed scene, or a compile error with the reason, which is clearest with an explicit
    /// mode: `timing_checked::<Latched>()`.
    ///
    /// # Panics
    /// If scene and mode do not agree; in a constant this is a compile error.
    #[track_caller]
    pub const fn timing_checked<M: OutputMode>(self) -> TimingChecked<Scene<E>, M>
    where
        E: SupportsTiming<M> + EnvironmentModel,
    {
        match self.time() {
            Ok(timed) => timed,
            Err(error) => match tightest_mode(&self.data, self.assessment.format, M::TIMING) {
                Err(refused) => refused.sentence().refuse(),
                Ok(_) => error.refuse(),
            },
        }
    }
}

impl Scene {
    /// Certifies the scene with unrounded coefficients; only a scene proved passive becomes [`Certified`].
    ///
    /// # Errors
    /// The reason why the scene is not certified.
    pub const fn certify(self) -> Result<Certified<Self>, Rejection> {
        self.certify_in(Format::F64)
    }

    /// Certifies the scene with the coefficients rounded to this number format.
    ///
    /// # Errors
    /// The reason why the scene is not certified.
    pub const fn certify_in(self, format: Format) -> Result<Certified<Self>, Rejection> {
        self.judged(self, format)
    }

    /// For constants: the certified scene, or a compile error with the reason.
    ///
    /// # Panics
    /// If the scene is not certified; in a constant this is a compile error.
    #[track_caller]
    pub const fn certified(self) -> Certified<Self> {
        match self.certify() {
            Ok(certified) => certified,
            Err(rejection) => refuse_scene(&self, &rejection, Format::F64),
        }
    }
}
