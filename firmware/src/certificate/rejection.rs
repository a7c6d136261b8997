//! The reason why a scene is not certified, as numbers and as text.

use super::remedy::{Remedies, Remedy};
use super::validity::InvalidParameter;
use crate::number::Format;
use crate::passivity::interval::Interval;
use crate::passivity::poles::UndecidedReason;
use crate::text::{Piece, Sentence, error_with_sentence, push};

/// The reason why a scene is not certified. Indices in N m s/rad, stiffnesses in N m/rad, torques in N m. Remedies are
/// changes of one number with which the scene would pass.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum Rejection {
    /// A number that is invalid in any scene.
    Invalid(InvalidParameter),
    /// The environment has more zeros than poles: it would need future positions.
    Improper,
    /// Coupling and undelayed environment have no unique solution within a tick: `1 + E(inf) V`, and 0 where the
    /// environment's own denominator degenerates.
    IllPosed { loop_gain: Interval },
    /// The device has no passivity.
    NoPassivity { delta: Interval },
    /// The mean of a torque profile is not zero, or no springs keep the device within its ends.
    Motor { mean: f64 },
    /// A nonlinear encoder makes an endless torque profile a motor, or what opposes the cogging has a mean (`anticogs`),
    /// and the stated friction does not hold the bound on this mean torque.
    MotorByInl { linearity: f64, mean: Interval, friction: f64, anticogs: bool, remedies: Remedies },
    /// What opposes the cogging needs all of the passivity; `None` if no bound is known for these times.
    Anticogging { needed: Option<f64>, delta: f64, remedies: Remedies },
    /// A torque limit would make the torque profile a motor.
    Uneven,
    /// A torque profile without delay is steeper than its coupling for the torque of the same tick.
    Steep { coupling: Interval, remedies: Remedies },
    /// A pole outside the unit circle, shown by a Schur-Cohn reflection coefficient of at least 1: of the environment
    /// alone, or caused by the coupling. Then there are remedies, and the standard coupling with the passing change of
    /// the stiffness behind it, if that coupling alone is not sufficient.
    UnstablePole {
        reflection: Interval,
        of_coupling: bool,
        remedies: Remedies,
        behind_standard: Option<(f64, Remedy)>,
    },
    /// A repeated pole on the unit circle, counting the integrator from velocity to position.
    RepeatedUnitPole { cos_theta: Interval },
    /// A pole on the unit circle whose residue does not have the pole's direction (equation 4).
    ResidueAngle { cos_theta: Interval },
    /// A common mode of numerator and denominator on the unit circle: it cancels in the transfer function,
    /// but not in the running law, where rounding excites it.
    HiddenMode { cos_theta: Interval },
    /// The environment pulls away at rest, a negative spring: the residue at `z = 1`.
    NegativeResidue { residue: Interval },
    /// The environment needs more damping than the device has (equation 17): the index of `E'` for linear scenes, the
    /// bound otherwise, its upper bound, and where the linear index is reached.
    Shortage { alpha: Interval, delta: Interval, cos_theta: Interval, remedies: Remedies },
    /// The environment would pass without missed updates, or without latched torques: the same index, and its upper
    /// bound with this coupling.
    Missed { alpha: Interval, limit: Interval, remedies: Remedies },
    /// The environment would pass behind the standard coupling, but not behind this coupling (equation 18): its index
    /// or bound alone, the index including this coupling if it was compared, and the stiffnesses of this coupling,
    /// `None` if it is rigid, and of the standard one, `2 delta / T`.
    Coupling {
        alpha: Option<Interval>,
        alpha_coupled: Option<Interval>,
        delta: Interval,
        /// Of a spring.
        stiffness: Option<Interval>,
        standard: Interval,
        remedies: Remedies,
    },
    /// Neither proved nor disproved; never counts as certified. The index, if it was enclosed, and its upper bound.
    Undecided {
        doubt: UndecidedReason,
        index: Option<Interval>,
        limit: Option<Interval>,
        remedies: Remedies,
    },
}

impl Rejection {
    pub(super) const fn shortage(alpha: Interval, delta: Interval, cos_theta: Interval) -> Self {
        Self::Shortage { alpha, delta, cos_theta, remedies: Remedies::NONE }
    }

    pub(super) const fn undecided(
        doubt: UndecidedReason,
        index: Option<Interval>,
        limit: Option<Interval>,
    ) -> Self {
        Self::Undecided { doubt, index, limit, remedies: Remedies::NONE }
    }

    /// The reason as a word for programs.
    pub const fn reason(&self) -> &'static str {
        match self {
            Self::Invalid(_) | Self::IllPosed { .. } | Self::Steep { .. } => "ill_posed",
            Self::Improper => "improper",
            Self::NoPassivity { .. }
            | Self::Shortage { .. }
            | Self::Missed { .. }
            | Self::Anticogging { needed: Some(_), .. } => "shortage",
            Self::UnstablePole { .. } => "unstable_pole",
            Self::RepeatedUnitPole { .. } => "repeated_unit_pole",
            Self::ResidueAngle { .. } | Self::HiddenMode { .. } => "residue_angle",
            Self::NegativeResidue { .. }
            | Self::Motor { .. }
            | Self::MotorByInl { .. }
            | Self::Uneven => "negative_residue",
            Self::Coupling { .. } => "coupling",
            Self::Undecided { .. } | Self::Anticogging { needed: None, .. } => "undecided",
        }
    }

    /// Whether this is [`Rejection::Undecided`].
    pub const fn is_undecided(&self) -> bool {
        matches!(self, Self::Undecided { .. } | Self::Anticogging { needed: None, .. })
    }

    /// Changes of one number with which the scene passes; each is certified.
    pub const fn remedies(&self) -> Remedies {
        match self {
            Self::UnstablePole { remedies, .. }
            | Self::Steep { remedies, .. }
            | Self::Shortage { remedies, .. }
            | Self::Missed { remedies, .. }
            | Self::Anticogging { remedies, .. }
            | Self::MotorByInl { remedies, .. }
            | Self::Coupling { remedies, .. }
            | Self::Undecided { remedies, .. } => *remedies,
            _ => Remedies::NONE,
        }
    }

    /// The rejection as text, the same at compile time, on the host and on the board.
    pub const fn sentence(&self) -> Sentence {
        self.sentence_in(Format::F64)
    }

    /// The same, beginning with the rounding of the numbers.
    pub const fn sentence_in(&self, format: Format) -> Sentence {
        let mut t = self.reason_in(format);
        let written = self.remedies().write(&mut t);
        if let Self::UnstablePole { behind_standard: Some((coupling, remedy)), .. } = self {
            t.push(if written == 0 { "; it would pass" } else { ", or" });
            push!(t, " behind a coupling of " {*coupling} " N m/rad with ");
            remedy.write(&mut t);
        }
        t
    }

    /// The same without the remedies.
    pub const fn reason_in(&self, format: Format) -> Sentence {
        let mut t = Sentence::new();
        if !matches!(format, Format::F64) {
            push!(t, "with its coefficients rounded to " {format.name().as_str()} ": ");
        }
        t.push(if self.is_undecided() { "undecided: " } else { "rejected: " });
        match self {
            Self::Invalid(invalid) => invalid.write(&mut t),
            Self::Improper => push!(
                t,
                "the environment has more zeros than poles, so it is not causal; add delay or poles"
            ),
            Self::IllPosed { loop_gain } => push!(t,
                "coupling and environment have no unique solution within a tick (1 + E(inf)/K_vc = "
                {if loop_gain.contains(0.0) { 0.0 } else { loop_gain.midpoint() }}
                "); delay the environment or change the coupling stiffness"),
            Self::NoPassivity { delta } => push!(t,
                "the device's passivity delta = " {delta.midpoint()} " N m s/rad must be greater than 0"),
            Self::Motor { mean } if *mean == 0.0 => push!(
                t,
                "nothing pushes back beyond the ends of the torque profile: the stiffness of its end stops must be \
                 greater than 0"
            ),
            Self::Motor { mean } => push!(t,
                "the torque profile repeats for ever, and its mean is " {*mean}
                " N m instead of 0: it would turn the device as a motor does"),
            Self::MotorByInl { mean, friction, anticogs: true, .. } => push!(t,
                "what repeats in each turn has a mean of up to " {mean.hi()} " N m over the angle of the device, by its \
                 learnt mean, by clipping, and by the linearity of the encoder: the device needs that much Coulomb \
                 friction against being turned, and states " {*friction} " N m"),
            Self::Anticogging { needed: Some(needed), delta, .. } => push!(t,
                "what opposes the cogging needs " {*needed} " N m s/rad of damping, and the device has delta = "
                {*delta} " N m s/rad"),
            Self::Anticogging { needed: None, .. } => push!(
                t,
                "no proof is known for what opposes the cogging beside these lags, jitters and missed updates"
            ),
            Self::MotorByInl { linearity, mean, friction, .. } => push!(t,
                "the torque profile repeats for ever, and read by an encoder with a linearity of " {*linearity}
                " its mean is up to " {mean.hi()} " N m, by which it would turn the device as a motor does: the device \
                 needs that much Coulomb friction, and states " {*friction}
                " N m; correct the angle, or give the profile end stops"),
            Self::Uneven => push!(
                t,
                "a torque limit would clip this torque profile on one side more than on the other, and the rest \
                 turns the device as a motor does: make it odd about its centre, or give it end stops"
            ),
            Self::Steep { coupling, .. } => push!(t,
                "without delay a torque profile must rise by less than the coupling's " {coupling.lo()}
                " N m/rad everywhere"),
            Self::UnstablePole { reflection, of_coupling, .. } => push!(t,
                {if *of_coupling { "behind this coupling " } else { "" }}
                "the environment has a pole outside the unit circle (reflection coefficient " {reflection.lo()}
                ", must be below 1)"),
            Self::RepeatedUnitPole { cos_theta } => push!(t,
                "from velocity to torque there is a repeated pole on the unit circle" {Angle(*cos_theta)}),
            Self::ResidueAngle { cos_theta } => push!(t,
                "a pole on the unit circle has a residue of the wrong angle" {Angle(*cos_theta)}),
            Self::HiddenMode { cos_theta } => push!(t,
                "numerator and denominator have a factor in common whose roots are on the unit circle"
                {Angle(*cos_theta)} ": its mode does not show and does not decay; divide both by that factor"),
            Self::NegativeResidue { residue } => push!(t,
                "the environment pulls away at rest like a negative spring (residue at z = 1 is "
                {residue.midpoint()} " N m s/rad, must be positive)"),
            Self::Shortage { alpha, delta, cos_theta, .. } => {
                push!(t,
                    "the environment needs alpha = " {alpha.hi()} " N m s/rad of damping, not below the delta = "
                    {delta.lo()} " N m s/rad that the device has");
                if cos_theta.hi() - cos_theta.lo() < 0.5 {
                    push!(t, { Angle(*cos_theta) });
                }
            }
            Self::Missed { alpha, limit, .. } => push!(t,
                "with updates missed up to the worst period and torques latched the environment needs alpha = "
                {alpha.hi()} " N m s/rad of damping, not below the " {limit.lo()}
                " N m s/rad that device and coupling leave it"),
            Self::Coupling { alpha, alpha_coupled, delta, stiffness, standard, .. } => {
                match stiffness {
                    Some(k) => push!(t, "the coupling stiffness " {k.midpoint()} " N m/rad"),
                    None => t.push("this coupling"),
                }
                t.push(" does not suit this environment");
                if let Some(alpha) = alpha {
                    push!(t, ": alone it needs alpha = " {alpha.hi()});
                }
                if let Some(coupled) = alpha_coupled {
                    push!(t, ", with the coupling alpha = " {coupled.hi()});
                }
                push!(t,
                    " N m s/rad of the delta = " {delta.lo()}
                    " N m s/rad that the device has; the standard coupling is 2 delta/T = " {standard.midpoint()}
                    " N m/rad");
            }
            Self::Undecided { doubt, index, limit, .. } => {
                t.push(doubt.as_str());
                if let (Some(index), Some(limit)) = (index, limit) {
                    push!(t, " (alpha = " {index.hi()} ", delta = " {limit.lo()} " N m s/rad)");
                }
            }
        }
        t
    }
}

/// The cosine of an angle, as a piece of a sentence.
struct Angle(Interval);

impl Piece<Angle> {
    const fn push_to(self, text: &mut Sentence) {
        push!(*text, " (at cos(theta) = " {self.0.0.midpoint()} ")");
    }
}

error_with_sentence!(Rejection);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Parameter, Remedy};

    /// What does not fit is cut off, which no sentence may be.
    #[test]
    fn the_longest_sentence_fits() {
        const LONG: f64 = -1.797_693_134e-300;
        /// Remedies have numbers of nine digits at most, and of three if there are two of them.
        const RANGE: (Option<f64>, Option<f64>) = (Some(1.23e-22), Some(1.24e-22));
        let exactly = (Some(1.234_567_89e-15), Some(1.234_567_89e-15));
        let remedy = |parameter, (lowest, highest)| Remedy { parameter, lowest, highest };
        let all = [
            remedy(Parameter::Stiffness, RANGE),
            remedy(Parameter::Damping, RANGE),
            remedy(Parameter::ProfileTorque, (None, Some(1.23e-22))),
            remedy(Parameter::Count, (None, Some(4096.0))),
            remedy(Parameter::CouplingStiffness, exactly),
            remedy(Parameter::Period, RANGE),
            remedy(Parameter::Passivity, (Some(1.23e-22), None)),
            remedy(Parameter::OutputDelay, RANGE),
            remedy(Parameter::ActuatorLag, RANGE),
            remedy(Parameter::SensorLag, RANGE),
            remedy(Parameter::Anticogging, RANGE),
        ];
        let of_profile = Remedies::of(all);
        let mut of_sum = all;
        of_sum[1].parameter = Parameter::Residual;
        let of_sum = Remedies::of(of_sum);
        // Only a profile has a number of repetitions; the others may have a residual.
        let mut others = all;
        others[2] = remedy(Parameter::Residual, RANGE);
        let mut remedies = Remedies::NONE;
        (0..others.len()).filter(|&i| i != 3).for_each(|i| remedies.put(i, Some(others[i])));
        let (coupling, long) = (Interval::exact(LONG), Interval::exact(LONG));
        let (alpha, index) = (Some(long), Some(long));
        let shortage =
            |remedies| Rejection::Shortage { alpha: long, delta: long, cos_theta: long, remedies };
        let doubt = UndecidedReason::ResidueSign;
        let last = "1.23e-22 <= anticogging <= 1.24e-22";
        let range = "1.23e-22 <= stiffness <= 1.24e-22 N m/rad";
        for (rejection, end) in [
            (
                Rejection::Coupling {
                    alpha,
                    alpha_coupled: alpha,
                    delta: long,
                    stiffness: alpha,
                    standard: long,
                    remedies,
                },
                last,
            ),
            (shortage(remedies), last),
            (Rejection::Undecided { doubt, index, limit: index, remedies }, last),
            (
                Rejection::UnstablePole {
                    reflection: long,
                    of_coupling: true,
                    remedies,
                    behind_standard: Some((LONG, all[0])),
                },
                range,
            ),
            (Rejection::Steep { coupling, remedies: of_profile }, last),
            (shortage(of_profile), last),
            (shortage(of_sum), last),
        ] {
            let sentence = rejection.sentence_in(Format::Fixed { fraction_bits: 16 });
            let sentence = sentence.as_str();
            assert!(sentence.len() < Sentence::CAPACITY, "{}: {sentence}", sentence.len());
            assert!(sentence.ends_with(end), "{sentence}");
        }
    }
}
