//! From a [`Scene`] to a [`Certified`] scene, or to a [`Rejection`] that says why not.
//!
//! At compile time and on the host all of it is known: the index, what stands against it, and what would
//! pass. A board limits every torque, and asks when it starts, and for every change that arrives over the
//! wire, for the part that decides then ([`Scene::timed_in`]), by the same functions.
//!
//! ```
//! use firmware::certificate::Certified;
//! use firmware::environment::DamperWall;
//! use firmware::scene::{Coupling, Device, Scene, Timing};
//!
//! type WallScene = Scene<DamperWall<1>>;
//! const WALL: WallScene = Scene {
//!     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
//!     timing: Timing { period: 0.001, worst_period: None },
//!     coupling: Coupling::Spring { stiffness: 44.0 },
//!     environment: DamperWall { stiffness: 22.0, damping: 0.01 },
//!     torque_limit: None,
//! };
//! // A constant that would not pass stops the compiler here, with the sentence below.
//! const CERTIFIED: Certified<WallScene> = WALL.certified();
//! let alpha = CERTIFIED.assessment().alpha.unwrap();
//! assert!(alpha.contains(0.021) && alpha.hi() < 0.022);
//!
//! let stiffer = Scene { environment: DamperWall { stiffness: 25.0, damping: 0.01 }, ..WALL };
//! let rejection = stiffer.certify().unwrap_err();
//! assert_eq!(rejection.reason(), "shortage");
//! assert!(rejection.to_string().contains("it would pass with stiffness <= 23.9 N m/rad"));
//! ```

mod assessment;
mod assumption;
mod between;
mod certify_scene;
mod digits;
mod margin;
mod model;
mod parameter;
mod posed;
mod rejection;
mod remedy;
mod remedy_search;
mod rest;
mod rules;
mod secant;
mod timed;
mod varied;

pub use assessment::{Assessment, assess, assess_in};
pub use assumption::{Assumption, Assumptions, Standing};
pub use certify_scene::CertifyScene;
pub use model::Loop;
pub use parameter::{InvalidParameter, Parameter};
pub use posed::Posed;
pub use rejection::Rejection;
pub use remedy::{Remedies, Remedy};
pub use rest::{Rest, Steps};
pub use rules::{Answer, Rule, gamma};
pub use timed::{Timed, TimingError};

pub use crate::text::Sentence;

use crate::environment::*;
use crate::number::Format;
use crate::output_timing::OutputMode;
use crate::scene::Scene;
use crate::step::Step;
use assessment::{Extent, assessed};

/// A scene that was proved passive.
///
/// There is no way to make one but `certify`, and a servo is built from nothing else: unchecked
/// parameters cannot drive the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certified<S> {
    scene: S,
    assessment: Assessment,
}

impl<S> Certified<S> {
    /// The scene that was certified.
    pub const fn scene(&self) -> &S {
        &self.scene
    }

    /// The numbers that the certificate rests on.
    pub const fn assessment(&self) -> &Assessment {
        &self.assessment
    }
}

/// Judges a scene given as data, as it was written: the certificate's numbers, or why there is no
/// certificate.
pub const fn certify(scene: &Scene) -> Result<Assessment, Rejection> {
    certify_in(scene, Format::F64)
}

/// The same of the coefficients that a servo in this number format multiplies by.
pub const fn certify_in(scene: &Scene, format: Format) -> Result<Assessment, Rejection> {
    let assessment = assessed(scene, format, Extent::OwnRule);
    match assessment.outcome {
        Ok(()) => Ok(assessment),
        Err(rejection) => Err(remedy_search::with_remedies(rejection, scene, format)),
    }
}

/// Stops the compiler with the sentence, at the line of the scene that is refused.
#[track_caller]
const fn refuse(sentence: &Sentence) -> ! {
    panic!("{}", sentence.as_str())
}

macro_rules! certify_for {
    ($([$($generics:tt)*] $environment:ty: $cancels:literal;)*) => {$(
        impl<$($generics)*> Scene<$environment> {
            /// The same scene with its environment as data.
            pub const fn as_data(&self) -> Scene {
                Scene {
                    device: self.device,
                    timing: self.timing,
                    coupling: self.coupling,
                    environment: self.environment.as_data(),
                    torque_limit: self.torque_limit,
                }
            }

            /// Judges the scene as it was written; only one that is proved passive becomes
            /// [`Certified`].
            pub const fn certify(self) -> Result<Certified<Self>, Rejection> {
                self.certify_in(Format::F64)
            }

            /// Judges the coefficients that a servo in this number format multiplies by.
            pub const fn certify_in(self, format: Format) -> Result<Certified<Self>, Rejection> {
                match certify_in(&self.as_data(), format) {
                    Ok(assessment) => Ok(Certified { scene: self, assessment }),
                    Err(rejection) => Err(rejection),
                }
            }

            /// The scene timed, if a board may render it: what [`Scene::certify_in`] and then
            /// [`Certified::time`] allow, at a fraction of the cost, without numbers and remedies.
            /// What a board asks for, whose host has the words.
            ///
            /// # Errors
            /// [`Step::Certificate`] where it may not.
            pub const fn timed_in<M: OutputMode>(
                self,
                format: Format,
            ) -> Result<Timed<Self, M>, Step>
            where
                $environment: Renders<M>,
            {
                let scene = self.as_data();
                // Asked here, where the type tells.
                let is_late = scene.environment.is_late();
                match timed::judged::<$cancels, M>(&scene, is_late, format) {
                    Ok(limited) => Ok(Timed::new(self, format, limited)),
                    Err(step) => Err(step),
                }
            }

            /// For constants: the certified scene, or a compile error that says why not.
            ///
            /// # Panics
            /// If the scene is not certified; in a constant that is the compile error.
            #[track_caller]
            pub const fn certified(self) -> Certified<Self> {
                match self.certify() {
                    Ok(certified) => certified,
                    Err(rejection) => refuse(&rejection.sentence()),
                }
            }
        }

        impl<$($generics)*> Certified<Scene<$environment>> {
            /// For constants: the same scene's certificate in the number format that it runs in,
            /// or a compile error that says why it has none there.
            ///
            /// # Panics
            /// If the coefficients as rounded to the format are not certified; in a constant that
            /// is the compile error.
            #[track_caller]
            pub const fn certified_in(self, format: Format) -> Self {
                match self.scene.certify_in(format) {
                    Ok(certified) => certified,
                    Err(rejection) => refuse(&rejection.sentence_in(format)),
                }
            }

            /// Pairs the scene with the mode in which a board puts its torques out.
            ///
            /// # Errors
            /// Where they do not agree; see [`TimingError`].
            pub const fn time<M: OutputMode>(
                self,
            ) -> Result<Timed<Scene<$environment>, M>, TimingError>
            where
                $environment: Renders<M>,
            {
                match timed::agree::<M>(&self.scene.as_data(), &self.assessment) {
                    Ok(limited) => Ok(Timed::new(self.scene, self.assessment.format, limited)),
                    Err(error) => Err(error),
                }
            }

            /// For constants: the timed scene, or a compile error that says why not, which is at
            /// its clearest where the mode is named: `timed::<Latched>()`.
            ///
            /// # Panics
            /// If scene and mode do not agree; in a constant that is the compile error.
            #[track_caller]
            pub const fn timed<M: OutputMode>(self) -> Timed<Scene<$environment>, M>
            where
                $environment: Renders<M>,
            {
                match self.time() {
                    Ok(timed) => timed,
                    Err(error) => refuse(&error.sentence()),
                }
            }
        }
    )*};
}

for_every_environment!(certify_for);
