//! Why a host's torque is refused.

use crate::text::{Sentence, error_with_sentence, push};

/// The reason why a scene cannot have this torque from a host beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum HostError {
    /// A number is zero, negative or not finite.
    NotPositive { name: &'static str, value: f64, unit: &'static str },
    /// The power in W is negative or not finite.
    Power { power: f64 },
    /// The share of damping is not below the scene's margin, both in N m s/rad.
    Share { damping: f64, margin: f64 },
    /// The scene has no margin that is known.
    NoMargin { damping: f64 },
    /// The host's torque and the scene's limit are together above full scale, all in N m; or there is no limit.
    Range { torque: f64, limit: Option<f64>, full_scale: f64 },
    /// The energy in J is not above the error that the encoder's counts can cause.
    Energy { energy: f64, least: f64 },
    /// A time of the scene for which there is no proof.
    NotCovered { time: &'static str },
}

impl HostError {
    pub(super) const fn unless_positive(
        name: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotPositive { name, value, unit })
        }
    }

    /// The error as a sentence.
    pub const fn sentence(&self) -> Sentence {
        let mut t = Sentence::new();
        match *self {
            Self::NotPositive { name, value, unit } => push!(t,
                "the host's " {name} " must be positive and finite, and is " {value} " " {unit}),
            Self::Power { power } => push!(t,
                "the host's power must be finite and 0 W or more, and is " {power} " W"),
            Self::Share { damping, margin } => push!(t,
                "the host's share of damping is " {damping} " N m s/rad, and must be below the margin of " {margin}
                " N m s/rad, the damping that the scene leaves over: lower the share, or make the scene softer"),
            Self::NoMargin { damping } => push!(t,
                "the host's share of damping is " {damping} " N m s/rad, and the scene has no known margin to take \
                 it from: where torques lag, a limited scene has none"),
            Self::Range { torque, limit: Some(limit), full_scale } => push!(t,
                "the host's largest torque of " {torque} " N m and the scene's torque limit of " {limit}
                " N m are together above the full scale of " {full_scale} " N m: lower one of them"),
            Self::Range { torque, limit: None, full_scale } => push!(t,
                "the scene has no torque limit and takes the full scale of " {full_scale} " N m, which leaves no \
                 room for the host's largest torque of " {torque} " N m: limit the scene's torque"),
            Self::Energy { energy, least } => push!(t,
                "the host's energy is " {energy} " J, and must be above " {least} " J, which the error of the \
                 encoder's counts can take at the host's largest torque: lower the torque, or take a finer encoder"),
            Self::NotCovered { time } => push!(t,
                "there is no proof for a host's torque beside " {time}),
        }
        t
    }
}

error_with_sentence!(HostError);
