//! What the certificate knows an environment by: those of this crate as data, those of other crates by
//! what they state of themselves, so that they are judged and rendered like the ones that are here.
//!
//! A type of another crate has a difference equation ([`Discretize`](super::Discretize)), numbers that
//! have names ([`NamedParameters`]), and a statement of what it is to the certificate
//! ([`StatedEnvironment`]). The certificate rests on that statement as it rests on the declared
//! passivity of the device: it lists it among its assumptions.
//!
//! A constant is certified with the statement as a value, since a trait's methods are not called at
//! compile time ([`Scene::certified_as`](crate::scene::Scene::certified_as)); a board asks the trait
//! again when it starts and for each change, and does not run a scene that passes only by the value.

use super::*;
use crate::parameter::NamedParameters;

/// An environment of another crate.
///
/// To run on a board it is [`Delayed`](super::Delayed) as well.
pub trait StatedEnvironment: NamedParameters + Copy + 'static {
    /// What it is to the certificate, in a scene with this period, damping and coupling. These may be
    /// any numbers: they are looked at later.
    fn stated(&self, context: &LawContext) -> StatedModel;
}

/// An environment that the certificate knows: one of this crate's, or a [`StatedEnvironment`].
pub trait EnvironmentModel: NamedParameters + Copy + sealed::Sealed + 'static {
    /// Whether it may cancel the device's damping. The program of an environment whose type says that
    /// it does not has nothing of what it takes to judge that.
    const CANCELS_DAMPING: bool;

    /// As data, which is what is judged.
    fn as_data(&self, context: &LawContext) -> Environment;
}

impl<E: StatedEnvironment> sealed::Sealed for E {}

impl<E: StatedEnvironment> EnvironmentModel for E {
    const CANCELS_DAMPING: bool = false;

    fn as_data(&self, context: &LawContext) -> Environment {
        Environment::Stated(self.stated(context))
    }
}

macro_rules! known_models {
    ($([$($generics:tt)*] $environment:ty: $cancels:literal;)*) => {$(
        impl<$($generics)*> sealed::Sealed for $environment {}

        impl<$($generics)*> EnvironmentModel for $environment {
            const CANCELS_DAMPING: bool = $cancels;

            fn as_data(&self, _: &LawContext) -> Environment {
                // The constant function of the type, which has the same name.
                <$environment>::as_data(self)
            }
        }
    )*};
}

for_every_environment!(known_models);
