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

use super::any::Environment;
use super::law::LawContext;
use super::parts::{PartSet, Parts};
use super::stated::StatedModel;
use crate::coupling::Coupling;
use crate::parameter::NamedParameters;
use crate::scene::Scene;

/// Traits for this crate's types alone.
pub(crate) mod sealed {
    pub trait Sealed {}
}

/// An environment of another crate.
///
/// To run on a board it must also be [`Delayed`](super::Delayed). In [`scene_program!`](crate::scene_program)
/// its value is in a pattern: it derives `PartialEq`, and has no string, function pointer or NaN.
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
    /// Those of the matched coupling.
    Matched {
        /// Whether the amplifier is updated several times in a period.
        updates: bool,
    },
    /// None, because it has no coupling.
    Uncoupled,
    /// Those that the scene requires.
    Any,
}

impl Memory {
    /// That of a program's scene.
    pub(crate) const fn of(scene: &Scene) -> Self {
        match scene.coupling {
            Coupling::Rigid => Self::Uncoupled,
            Coupling::Spring { .. } => Self::None,
            Coupling::Matched => Self::Matched { updates: scene.latency.actuator_updates != 0 },
        }
    }

    /// Whether it may be behind a coupling that stores torques. If not, the program omits the code for such
    /// a coupling.
    pub const fn is_stored(self) -> bool {
        matches!(self, Self::Any | Self::Matched { .. })
    }

    /// Whether a board renders it without a coupling. If not, the program omits the certificate's code for
    /// that.
    pub const fn may_be_uncoupled(self) -> bool {
        matches!(self, Self::Any | Self::Uncoupled)
    }

    /// Whether it may have a coupling.
    pub const fn may_be_coupled(self) -> bool {
        !matches!(self, Self::Uncoupled)
    }

    /// Whether the amplifier may be updated several times in a period. If not, the program omits the code for
    /// such a coupling.
    pub const fn has_updates(self) -> bool {
        matches!(self, Self::Any | Self::Matched { updates: true })
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
    pub const NONE: Self = Self::all(false);
    /// Any profile.
    pub const ANY: Self = Self::all(true);

    const fn all(is: bool) -> Self {
        Self { exists: is, is_prompt: is, is_damped: is, snaps: is, has_modes: is, is_composed: is }
    }

    /// That of a program's environment.
    pub(crate) const fn of(parts: &Parts) -> Self {
        match &parts.profile {
            Some(profile) => Self {
                exists: true,
                is_prompt: profile.delay == 0,
                is_damped: profile.damping.is_some(),
                snaps: profile.snap.is_some() || profile.modes.is_some(),
                has_modes: profile.modes.is_some(),
                is_composed: parts.count() > 1,
            },
            None => Self::NONE,
        }
    }
}

/// An environment for the certificate: one of this crate, or a [`StatedEnvironment`].
pub trait EnvironmentModel: NamedParameters + Copy + sealed::Sealed + 'static {
    /// The parts that it may have.
    const PARTS: PartSet;

    /// Whether it is a sum of parts with the delays of its type, which no change of a parameter alters. Its
    /// program omits the code for other environments.
    const IS_SUM: bool = false;

    /// Its possible use of a torque profile.
    const PROFILE: ProfileUse;

    /// The past torques that its law stores for a coupling.
    const MEMORY: Memory;

    /// Whether the encoder's readings may be other than those of an ideal encoder with the same times. If not,
    /// the program omits the certificate's code for them.
    const MAY_MISREAD: bool = true;

    /// As data, for the certificate.
    fn as_data(&self, context: &LawContext) -> Environment;
}

/// [`Environment::is_late`] of an environment of the type `E`.
#[inline(always)]
pub(crate) const fn is_late<E: EnvironmentModel>(environment: &Environment) -> bool {
    match environment {
        Environment::Parts(parts) => parts.is_late(),
        _ => !E::IS_SUM && environment.is_late(),
    }
}

impl<E: StatedEnvironment> sealed::Sealed for E {}

impl<E: StatedEnvironment> EnvironmentModel for E {
    const PARTS: PartSet = PartSet::NONE;
    const PROFILE: ProfileUse = ProfileUse::NONE;
    const MEMORY: Memory = Memory::None;

    fn as_data(&self, context: &LawContext) -> Environment {
        Environment::Stated(self.stated(context))
    }
}

impl sealed::Sealed for Environment {}

impl EnvironmentModel for Environment {
    const PARTS: PartSet = PartSet::ALL;
    const PROFILE: ProfileUse = ProfileUse::ANY;
    const MEMORY: Memory = Memory::Any;

    fn as_data(&self, _: &LawContext) -> Environment {
        *self
    }
}
