//! The way of every environment's scene from numbers to a timed certificate, for code that is
//! generic over the environment.

use super::{Certified, Rejection, Timed, TimingError};
use crate::environment::*;
use crate::number::Number;
use crate::output_timing::OutputMode;
use crate::scene::Scene;
use crate::step::Step;

/// An environment whose scenes can be judged, timed and rendered in the number format `N`.
pub trait CertifyScene<N: Number>: Renderable<N> + Copy + 'static {
    /// The scene timed, if the coefficients as rounded to the number format and the mode allow it.
    /// Does not look for reasons and remedies, so that a board has nothing of what it takes to find
    /// them.
    ///
    /// # Errors
    /// What does not allow it.
    fn timed<M: OutputMode>(scene: Scene<Self>) -> Result<Timed<Scene<Self>, M>, Step>
    where
        Self: Renders<M>;

    /// The certificate of the coefficients as rounded to the number format.
    ///
    /// # Errors
    /// Why the scene is not certified, and what would be.
    fn certify(scene: Scene<Self>) -> Result<Certified<Scene<Self>>, Rejection>;

    /// [`Certified::time`].
    ///
    /// # Errors
    /// Where scene and mode do not agree.
    fn time<M: OutputMode>(
        certified: Certified<Scene<Self>>,
    ) -> Result<Timed<Scene<Self>, M>, TimingError>
    where
        Self: Renders<M>;

    /// [`Scene::as_data`].
    fn as_data(scene: &Scene<Self>) -> Scene;
}

macro_rules! certify_scene {
    ($([$($generics:tt)*] $environment:ty: $cancels:literal;)*) => {$(
        impl<F: Number, $($generics)*> CertifyScene<F> for $environment {
            fn timed<M: OutputMode>(scene: Scene<Self>) -> Result<Timed<Scene<Self>, M>, Step>
            where
                Self: Renders<M>,
            {
                scene.timed_in(F::FORMAT)
            }

            fn certify(scene: Scene<Self>) -> Result<Certified<Scene<Self>>, Rejection> {
                scene.certify_in(F::FORMAT)
            }

            fn time<M: OutputMode>(
                certified: Certified<Scene<Self>>,
            ) -> Result<Timed<Scene<Self>, M>, TimingError>
            where
                Self: Renders<M>,
            {
                certified.time()
            }

            fn as_data(scene: &Scene<Self>) -> Scene {
                scene.as_data()
            }
        }
    )*};
}

for_every_environment!(certify_scene);
