//! Models of environments for the certificate: environments of this crate as data, environments of other
//! crates by a statement of their properties, so that all are certified and rendered in the same way.
//!
//! A type of another crate has a difference equation ([`Discretize`](super::Discretize)), named numbers
//! ([`NamedParameters`]), and a statement for the certificate ([`StatedEnvironment`]). The certificate relies
//! on that statement like on the declared passivity of the device, and lists it among its assumptions.
//!
//! A constant is certified with the statement as a value, because a trait's methods cannot be called at
//! compile time ([`Scene::certified_as`](crate::scene::Scene::certified_as)). A board calls the trait's
//! method at its start and for each change, and does not run a scene that passes only with the value.

use super::*;
use crate::coupling::Coupling;
use crate::latency::Latency;
use crate::parameter::NamedParameters;

/// An environment of another crate.
///
/// To run on a board it must also be [`Delayed`](super::Delayed).
pub trait StatedEnvironment: NamedParameters + Copy + 'static {
    /// Its model for the certificate, in a scene with this period, damping and coupling. These may be any
    /// numbers; they are checked later.
    fn stated(&self, context: &LawContext) -> StatedModel;
}

/// The past torques that the law of a type of environment stores for its coupling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// None: it has no coupling, or a spring.
    None,
    /// Those for the latency in the parameters of [`Matched`].
    Of {
        /// [Whole samples](Latency::whole_samples) of the output delay.
        whole: usize,
        /// The number of [lags](Latency::trails) of amplifier and sensor, where a lag in a range counts twice.
        lags: usize,
        /// Whether the amplifier is updated several times in a period.
        updates: bool,
    },
    /// None, because it has no coupling, as [`Uncoupled`].
    Uncoupled,
    /// Those that the scene requires.
    Any,
}

impl Memory {
    /// Whether it is sufficient for a scene with this coupling and latency.
    pub const fn serves(self, coupling: &Coupling, latency: &Latency, period: f64) -> bool {
        let is_matched = matches!(coupling, Coupling::Matched);
        match self {
            Self::None => !is_matched,
            Self::Uncoupled => matches!(coupling, Coupling::Rigid),
            Self::Any => true,
            Self::Of { whole, lags, updates } => {
                let is_updated = latency.actuator_updates != 0;
                is_matched
                    && latency.whole_samples(period) == whole
                    && latency.trails() == lags
                    && is_updated == updates
            }
        }
    }

    /// Whether it may be behind a coupling that stores torques. If not, the program omits the code for such
    /// a coupling.
    pub const fn is_stored(self) -> bool {
        matches!(self, Self::Any | Self::Of { .. })
    }

    /// Whether a board renders it without a coupling. If not, the program omits the certificate's code for
    /// that.
    pub const fn may_be_uncoupled(self) -> bool {
        matches!(self, Self::Any | Self::Uncoupled)
    }

    /// Whether the amplifier may be updated several times in a period. If not, the program omits the code for
    /// such a coupling.
    pub const fn has_updates(self) -> bool {
        matches!(self, Self::Any | Self::Of { updates: true, .. })
    }
}

/// The possible torque profiles of a type of environment. Its program omits the certificate's code for all
/// others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfileUse {
    /// Whether it may have a torque profile, alone or in a sum.
    pub exists: bool,
    /// Whether the profile may be undelayed.
    pub is_prompt: bool,
    /// Whether the profile may have its own damper.
    pub is_damped: bool,
    /// Whether the profile may have a snap point.
    pub snaps: bool,
    /// Whether the profile may be one of several modes.
    pub has_modes: bool,
    /// Whether the profile may be part of a sum.
    pub is_composed: bool,
}

impl ProfileUse {
    /// No profile.
    pub const NONE: Self = Self {
        exists: false,
        is_prompt: false,
        is_damped: false,
        snaps: false,
        has_modes: false,
        is_composed: false,
    };
    /// Any profile.
    pub const ANY: Self = Self {
        exists: true,
        is_prompt: true,
        is_damped: true,
        snaps: true,
        has_modes: true,
        is_composed: true,
    };

    /// A table, late by `delay` samples.
    pub const fn table(delay: usize) -> Self {
        Self { exists: true, is_prompt: delay == 0, ..Self::NONE }
    }

    /// A table with a damper.
    pub const fn damped(delay: usize) -> Self {
        Self { is_damped: true, ..Self::table(delay) }
    }

    /// A table with a snap point.
    pub const fn snap(delay: usize) -> Self {
        Self { snaps: true, ..Self::table(delay) }
    }

    /// Tables, one of which is selected.
    pub const fn modes(delay: usize) -> Self {
        Self { has_modes: true, ..Self::snap(delay) }
    }

    /// A table in a sum.
    pub const fn sum(delay: usize) -> Self {
        Self { is_composed: true, ..Self::table(delay) }
    }
}

/// An environment for the certificate: one of this crate, or a [`StatedEnvironment`].
pub trait EnvironmentModel: NamedParameters + Copy + sealed::Sealed + 'static {
    /// Whether it may cancel the device's damping. If not, the program of the environment omits the
    /// code that certifies cancelled damping.
    const CANCELS_DAMPING: bool;

    /// Its possible use of a torque profile.
    const PROFILE: ProfileUse;

    /// The past torques that its law stores for a coupling.
    const MEMORY: Memory;

    /// As data, for the certificate.
    fn as_data(&self, context: &LawContext) -> Environment;
}

impl<E: StatedEnvironment> sealed::Sealed for E {}

impl<E: StatedEnvironment> EnvironmentModel for E {
    const CANCELS_DAMPING: bool = false;
    const PROFILE: ProfileUse = ProfileUse::NONE;
    const MEMORY: Memory = Memory::None;

    fn as_data(&self, context: &LawContext) -> Environment {
        Environment::Stated(self.stated(context))
    }
}

macro_rules! known_models {
    ($(
        [$($generics:tt)*] $environment:ty:
        $cancels:literal, $memory:ident, $profile:expr;
    )*) => {$(
        impl<const WHOLE: usize, const LAGS: usize, const UPDATES: bool, $($generics)*> sealed::Sealed
            for Matched<$environment, WHOLE, LAGS, UPDATES>
        {
        }

        impl<const WHOLE: usize, const LAGS: usize, const UPDATES: bool, $($generics)*> EnvironmentModel
            for Matched<$environment, WHOLE, LAGS, UPDATES>
        {
            const CANCELS_DAMPING: bool = $cancels;
            const PROFILE: ProfileUse = $profile;
            const MEMORY: Memory = Memory::Of { whole: WHOLE, lags: LAGS, updates: UPDATES };

            fn as_data(&self, _: &LawContext) -> Environment {
                Self::as_data(self)
            }
        }

        impl<const WHOLE: usize, const LAGS: usize, const UPDATES: bool, $($generics)*>
            Matched<$environment, WHOLE, LAGS, UPDATES>
        {
            /// The environment as data.
            pub const fn as_data(&self) -> Environment {
                self.environment.as_data()
            }
        }

        impl<$($generics)*> sealed::Sealed for Uncoupled<$environment> {}

        impl<$($generics)*> EnvironmentModel for Uncoupled<$environment> {
            const CANCELS_DAMPING: bool = $cancels;
            const PROFILE: ProfileUse = $profile;
            const MEMORY: Memory = Memory::Uncoupled;

            fn as_data(&self, _: &LawContext) -> Environment {
                Self::as_data(self)
            }
        }

        impl<$($generics)*> Uncoupled<$environment> {
            /// The environment as data.
            pub const fn as_data(&self) -> Environment {
                self.environment.as_data()
            }
        }

        impl<$($generics)*> sealed::Sealed for $environment {}

        impl<$($generics)*> EnvironmentModel for $environment {
            const CANCELS_DAMPING: bool = $cancels;
            const PROFILE: ProfileUse = $profile;
            const MEMORY: Memory = Memory::$memory;

            fn as_data(&self, _: &LawContext) -> Environment {
                // The constant function of the type, which has the same name.
                <$environment>::as_data(self)
            }
        }
    )*};
}

for_every_environment!(known_models);
