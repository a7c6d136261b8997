//! Models of environments for the certificate: those of this crate as data, those of other crates by a
//! statement of their properties, so that they are certified and rendered like this crate's.
//!
//! A type of another crate has a difference equation ([`Discretize`](super::Discretize)), named
//! numbers ([`NamedParameters`]), and a statement for the certificate ([`StatedEnvironment`]). The
//! certificate relies on that statement as it relies on the declared passivity of the device: it
//! lists it among its assumptions.
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
    /// Whether it may cancel the device's damping. If not, the program of the environment omits the
    /// code that certifies cancelled damping.
    const CANCELS_DAMPING: bool;

    /// As data, for the certificate.
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
