//! Any environment as data: for scenes that come from a file or over the wire, and for the certificate.

use super::anticogging::Anticogging;
use super::parts::{Parts, for_each_part};
use super::rational::Rational;
use super::stated::StatedModel;
use super::wall::Wall;

/// Any environment as data.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Environment {
    /// A sum of parts.
    Parts(Parts),
    /// An environment of another crate.
    Stated(StatedModel),
    /// [`Rational`].
    // No board renders one, so it is not on the wire.
    #[cfg_attr(feature = "wire", serde(skip))]
    Rational(Rational),
}

impl Environment {
    /// Its parts; none if it is not a sum of parts.
    pub const fn parts(&self) -> &Parts {
        match self {
            Self::Parts(parts) => parts,
            Self::Stated(_) | Self::Rational(_) => &Parts::NONE,
        }
    }

    /// The wall, mutable.
    pub const fn wall_mut(&mut self) -> Option<&mut Wall> {
        match self {
            Self::Parts(parts) => parts.wall.as_mut(),
            Self::Stated(_) | Self::Rational(_) => None,
        }
    }

    /// Whether its torque jumps when a knob snaps from one detent to the next.
    pub(crate) const fn snaps(&self) -> bool {
        match self.profile() {
            Some(profile) => profile.snap.is_some(),
            None => false,
        }
    }

    /// The rational function of the environment, or of its statement.
    pub const fn rational(&self) -> Option<&Rational> {
        match self {
            Self::Rational(rational) => Some(rational),
            Self::Stated(StatedModel::Linear(rational)) => Some(rational),
            _ => None,
        }
    }

    /// Whether it is linear apart from a face and a torque limit.
    pub const fn has_transfer(&self) -> bool {
        !matches!(self, Self::Stated(StatedModel::Bounded { .. })) && self.profile().is_none()
    }

    /// Whether all its parts are late by at least one sample, so that its torque is known a tick early: only
    /// such an environment can be rendered with latched torques.
    pub const fn is_late(&self) -> bool {
        match self {
            Self::Parts(parts) => parts.is_late(),
            _ => self.delay() > 0,
        }
    }

    /// Its delay in whole samples; for a sum, the delay of the torque profile, else of the wall.
    pub const fn delay(&self) -> usize {
        match self {
            Self::Parts(parts) => parts.delay(),
            Self::Stated(StatedModel::Bounded { delay, .. }) => *delay,
            Self::Rational(rational) | Self::Stated(StatedModel::Linear(rational)) => {
                rational.whole_delay()
            }
        }
    }

    /// The delay in whole samples, mutable; `None` if it has no part.
    pub(crate) const fn delay_mut(&mut self) -> Option<&mut usize> {
        match self {
            Self::Parts(parts) => parts.delay_mut(),
            Self::Stated(StatedModel::Bounded { delay, .. }) => Some(delay),
            Self::Rational(rational) | Self::Stated(StatedModel::Linear(rational)) => {
                Some(&mut rational.delay)
            }
        }
    }
}

impl Environment {
    /// The same with the cogging of the motor opposed; a rational or a stated environment stays as it is.
    pub const fn beside(self, anticogging: Anticogging) -> Self {
        let mut out = self;
        if let Self::Parts(parts) = &mut out {
            parts.anticogging = Some(anticogging);
        }
        out
    }
}

impl Parts {
    /// The environment that is their sum.
    pub const fn sum(self) -> Environment {
        Environment::Parts(self)
    }
}

macro_rules! of_parts {
    ($($law:ident $part:ident: $data:ty,)+) => {
        impl Environment {$(
            #[doc = concat!("The ", stringify!($part), ", if it has one.")]
            pub const fn $part(&self) -> Option<&$data> {
                self.parts().$part.as_ref()
            }
        )+}

        $(impl $data {
            /// The environment of which it is the only part.
            pub const fn alone(self) -> Environment {
                Parts { $part: Some(self), ..Parts::NONE }.sum()
            }
        })+
    };
}
for_each_part!(of_parts);
