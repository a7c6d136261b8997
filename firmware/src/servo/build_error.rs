//! What can go wrong between a certified scene and a servo.

use core::fmt;

use crate::number::{Format, Number, OutOfRange};
use crate::text::Written;

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
    /// The scene is certified as it was written, or in another number format, and its coefficients
    /// as rounded to this one are not.
    Uncertified {
        /// This format.
        format: Format,
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
    /// The scene's certificate has no room for damping that is switched on and off.
    Injection {
        /// The damping in N m s/rad.
        damping: f64,
        /// What it has to stay below in N m s/rad.
        room: f64,
    },
    /// The encoder's counter would wrap unseen at the largest speed.
    Speed {
        /// Counts between two ticks at the largest speed.
        counts: f64,
        /// Half the counter's range.
        half: f64,
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
                let value = Written(*value);
                write!(f, "the {name} must be positive and finite, and is {value}")
            }
            Self::TorqueLimit { limit, full_scale } => write!(
                f,
                "the torque limit of {limit} N m is above the converter's full scale of \
                 {full_scale} N m: lower it to that, or scale the amplifier up",
                limit = Written(*limit),
                full_scale = Written(*full_scale),
            ),
            Self::Unrepresentable { name, reason } => write!(f, "the {name}: {reason}"),
            Self::Uncertified { format } => write!(
                f,
                "the scene is certified, but not with its coefficients rounded to {format}: ask \
                 for its certificate in that format, which says why, and leave more margin"
            ),
            Self::IllPosed { line, contact } => write!(
                f,
                "coupling and environment have no unique solution: the loop gain 1 + f / K is \
                 {line} out of contact and {contact} in contact, and must be positive; a stiffer \
                 coupling or a delayed environment has one",
                line = Written(*line),
                contact = Written(*contact),
            ),
            Self::Delay { delay, largest } => {
                write!(f, "a delay of {delay} samples is longer than the {largest} that are stored")
            }
            Self::Improper { numerator, denominator } => write!(
                f,
                "a numerator of degree {numerator} over a denominator of degree {denominator} \
                 needs samples from the future"
            ),
            Self::Injection { damping, room } => write!(
                f,
                "a damping of {damping} N m s/rad that is switched on and off uses up as much of \
                 the device's passivity, of which this scene leaves less than {room} N m s/rad: \
                 inject less, or make the scene softer",
                damping = Written(*damping),
                room = Written(*room),
            ),
            Self::Speed { counts, half } => write!(
                f,
                "at the largest speed the encoder may move by {counts} counts between two \
                 ticks, of which its counter tells only those below {half}: a shorter worst \
                 period or a wider counter tells them all",
                counts = Written(*counts),
                half = Written(*half),
            ),
        }
    }
}

impl core::error::Error for BuildError {}
