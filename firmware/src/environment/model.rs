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
use crate::coupling::Coupling;
use crate::latency::Latency;
use crate::parameter::NamedParameters;

/// An environment of another crate.
///
/// To run on a board it is [`Delayed`](super::Delayed) as well.
pub trait StatedEnvironment: NamedParameters + Copy + 'static {
    /// What it is to the certificate, in a scene with this period, damping and coupling. These may be
    /// any numbers: they are looked at later.
    fn stated(&self, context: &LawContext) -> StatedModel;
}

/// What the law of a type of environment remembers of past torques, for its coupling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// Nothing: it is behind no coupling, or behind a spring.
    None,
    /// What [`Matched`] says of its scene's latency.
    Of {
        /// Whole samples of the output delay.
        whole: usize,
        /// How many of amplifier and sensor lag.
        lags: usize,
    },
    /// Whatever the scene asks for.
    Any,
}

impl Memory {
    /// Whether it is what a scene with this coupling and latency needs.
    pub const fn serves(self, coupling: &Coupling, latency: &Latency, period: f64) -> bool {
        let is_matched = matches!(coupling, Coupling::Matched);
        match self {
            Self::None => !is_matched,
            Self::Any => true,
            Self::Of { whole, lags } => {
                let needed = (latency.torque_delay().middle() / period) as usize;
                let lagging = !latency.actuator_lag.is_zero() as usize
                    + !latency.sensor_lag.is_zero() as usize;
                is_matched && needed == whole && lagging == lags
            }
        }
    }
}

/// An environment that the certificate knows: one of this crate's, or a [`StatedEnvironment`].
pub trait EnvironmentModel: NamedParameters + Copy + sealed::Sealed + 'static {
    /// Whether it may cancel the device's damping. If not, the program of the environment omits the
    /// code that certifies cancelled damping.
    const CANCELS_DAMPING: bool;

    /// Whether it may be a torque profile. If not, the program omits the code that certifies one.
    const HAS_KNOTS: bool;

    /// Whether something may be beside its torque profile. If not, the program omits the code that certifies
    /// such a sum.
    const IS_COMPOSED: bool;

    /// What its law remembers for a coupling.
    const MEMORY: Memory;

    /// As data, for the certificate.
    fn as_data(&self, context: &LawContext) -> Environment;
}

impl<E: StatedEnvironment> sealed::Sealed for E {}

impl<E: StatedEnvironment> EnvironmentModel for E {
    const CANCELS_DAMPING: bool = false;
    const HAS_KNOTS: bool = false;
    const IS_COMPOSED: bool = false;
    const MEMORY: Memory = Memory::None;

    fn as_data(&self, context: &LawContext) -> Environment {
        Environment::Stated(self.stated(context))
    }
}

macro_rules! known_models {
    (@) => { false };
    (@ composed) => { true };
    ($(
        [$($generics:tt)*] $environment:ty:
        $cancels:literal, $memory:ident, $knots:literal $(, $composed:ident)?;
    )*) => {$(
        impl<const WHOLE: usize, const LAGS: usize, $($generics)*> sealed::Sealed
            for Matched<$environment, WHOLE, LAGS>
        {
        }

        impl<const WHOLE: usize, const LAGS: usize, $($generics)*> EnvironmentModel
            for Matched<$environment, WHOLE, LAGS>
        {
            const CANCELS_DAMPING: bool = $cancels;
            const HAS_KNOTS: bool = $knots;
            const IS_COMPOSED: bool = known_models!(@ $($composed)?);
            const MEMORY: Memory = Memory::Of { whole: WHOLE, lags: LAGS };

            fn as_data(&self, _: &LawContext) -> Environment {
                Self::as_data(self)
            }
        }

        impl<const WHOLE: usize, const LAGS: usize, $($generics)*>
            Matched<$environment, WHOLE, LAGS>
        {
            /// The environment as data.
            pub const fn as_data(&self) -> Environment {
                self.environment.as_data()
            }
        }

        impl<$($generics)*> sealed::Sealed for $environment {}

        impl<$($generics)*> EnvironmentModel for $environment {
            const CANCELS_DAMPING: bool = $cancels;
            const HAS_KNOTS: bool = $knots;
            const IS_COMPOSED: bool = known_models!(@ $($composed)?);
            const MEMORY: Memory = Memory::$memory;

            fn as_data(&self, _: &LawContext) -> Environment {
                // The constant function of the type, which has the same name.
                <$environment>::as_data(self)
            }
        }
    )*};
}

for_every_environment!(known_models);
