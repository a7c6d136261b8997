//! The torque limit, which acts on the coupling torque before the coupling is solved, so that
//! saturation is part of the environment and inside the certificate (theory, end of section 5).

use core::fmt;
use core::hint::cold_path;

use crate::number::Number;

/// Why a tick's output is less than the environment asked for. This is telemetry, not a fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum LimitReason {
    /// Nothing was limited.
    #[default]
    None = 0,
    /// The scene's torque limit.
    Torque = 1,
    /// The converter's full scale; the scene has no limit of its own.
    Converter = 2,
    /// The position left the range of the number format; the angle stands still.
    Angle = 3,
    /// The torque was not a number; no torque was given.
    NotANumber = 4,
}

impl LimitReason {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 5] =
        [Self::None, Self::Torque, Self::Converter, Self::Angle, Self::NotANumber];

    /// The reason in one word, for tables.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Torque => "torque",
            Self::Converter => "converter",
            Self::Angle => "angle",
            Self::NotANumber => "not-a-number",
        }
    }
}

impl fmt::Display for LimitReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// Clamps the coupling torque to `-bound..=bound`.
#[derive(Clone, Copy, Debug)]
pub struct Limiter<N> {
    bound: N,
    reason: LimitReason,
}

impl<N: Number> Limiter<N> {
    /// A limiter with its bound in N m, and the reason that it reports; with an infinite bound only
    /// what is not a number is limited.
    pub const fn new(bound: N, reason: LimitReason) -> Self {
        Self { bound, reason }
    }

    /// The torque within bounds, and why it is not the one asked for; `otherwise` where it is.
    #[inline(always)]
    pub fn limit(&self, wanted: N, otherwise: LimitReason) -> (N, LimitReason) {
        if wanted.within(self.bound) {
            return (wanted, otherwise);
        }
        // Rare: keeps the usual way through the tick free of jumps.
        cold_path();
        if wanted > N::ZERO {
            (self.bound, self.reason)
        } else if wanted < N::ZERO {
            (self.bound.negated(), self.reason)
        } else {
            (N::ZERO, LimitReason::NotANumber)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_it_did() {
        let limiter = Limiter::new(2.0_f32, LimitReason::Torque);
        let limit = |wanted| limiter.limit(wanted, LimitReason::None);
        assert_eq!(limit(2.0), (2.0, LimitReason::None));
        assert_eq!(limit(2.1), (2.0, LimitReason::Torque));
        assert_eq!(limit(-2.0), (-2.0, LimitReason::None));
        assert_eq!(limit(f32::NEG_INFINITY), (-2.0, LimitReason::Torque));
        assert_eq!(limit(f32::NAN), (0.0, LimitReason::NotANumber));
        assert_eq!(limiter.limit(1.0, LimitReason::Angle), (1.0, LimitReason::Angle));
        assert_eq!(limiter.limit(3.0, LimitReason::Angle), (2.0, LimitReason::Torque));
    }

    #[test]
    fn has_a_word_for_every_reason() {
        let words = ["none", "torque", "converter", "angle", "not-a-number"];
        assert_eq!(LimitReason::ALL.map(LimitReason::as_str), words);
        for (number, reason) in LimitReason::ALL.into_iter().enumerate() {
            assert_eq!((reason as usize, reason.to_string()), (number, words[number].to_owned()));
        }
    }
}
