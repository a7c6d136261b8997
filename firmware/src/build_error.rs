//! Errors between a certified scene and a servo.

use crate::number::{Format, Number, OutOfRange};
use crate::text::{Sentence, error_with_sentence, push};

/// The reason why a certified scene cannot run with these transducers in this number format.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum BuildError {
    /// A scale, a period or a limit is zero, negative or not finite.
    NotPositive { name: &'static str, value: f64 },
    /// The scene's torque limit in N m is above the torque at the DAC's largest code.
    TorqueLimit { limit: f64, full_scale: f64 },
    /// A constant of the scene does not fit the number format.
    Unrepresentable { name: &'static str, reason: OutOfRange },
    /// The scene is certified with unrounded coefficients or in another number format, but not with the
    /// coefficients rounded to this format.
    Uncertified { format: Format },
    /// The loop of coupling and environment has no solution, or more than one: `1 + f / K_vc` with the environment's
    /// slope `f`, out of contact and in contact with a wall that can only push.
    IllPosed { line: f64, contact: f64 },
    /// The environment is delayed by more samples than are stored.
    Delay { delay: usize, largest: usize },
    /// The law of an environment that is declared late computes a torque from the present position.
    NotLate,
    /// The numbers are those of a scene with other parts, delays or another coupling than the program's.
    Structure,
    /// There is no matched coupling for the scene's latency.
    NoMatchedCoupling,
    /// The environment repeats in each turn, and a turn is not a whole number of encoder counts, up to the largest.
    Turn { counts: f64, largest: f64 },
    /// The knob would snap there and back within a count of the encoder, both in rad.
    Hysteresis { hysteresis: f64, count: f64 },
    /// The environment is only known by its bounds; its law is in another crate.
    LawElsewhere,
    /// The numerator has a higher degree than the denominator, or the denominator is zero.
    Improper { numerator: usize, denominator: usize },
    /// The scene's certificate allows less injected damping in N m s/rad.
    Injection { damping: f64, room: f64 },
    /// A push into the scene returns more energy in J to the supply than it takes below its fault level; infinite if
    /// no bound is known.
    Returned { energy: f64, largest: f64 },
    /// The encoder's counter could wrap undetected: counts between two ticks at the largest speed, and half its
    /// range.
    Speed { counts: f64, half: f64 },
    /// No board can pace the scene's period in s; the range that every board can.
    Period { period: f64, shortest: f64, longest: f64 },
}

impl BuildError {
    /// Rejects values that are not positive and finite. Not inlined, like the two functions below: a board
    /// would have a copy for each number.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) const fn unless_positive(name: &'static str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotPositive { name, value })
        }
    }

    /// Rounds a coefficient; the error names it.
    ///
    /// # Errors
    /// If the number format cannot represent it.
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn coefficient<N: Number>(name: &'static str, value: f64) -> Result<N::Coefficient, Self> {
        N::coefficient(value).map_err(|reason| Self::Unrepresentable { name, reason })
    }

    /// Rounds an angle or a torque; the error names it.
    ///
    /// # Errors
    /// If the number format cannot represent it.
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn number<N: Number>(name: &'static str, value: f64) -> Result<N, Self> {
        N::from_f64(value).map_err(|reason| Self::Unrepresentable { name, reason })
    }

    /// The error as a sentence, the same at compile time, on the host and on the board.
    pub const fn sentence(&self) -> Sentence {
        let mut t = Sentence::new();
        match *self {
            Self::NotPositive { name, value } => {
                push!(t, "the " {name} " must be positive and finite, and is " {value});
            }
            Self::TorqueLimit { limit, full_scale } => push!(t,
                "the torque limit of " {limit} " N m is above the DAC's full scale of " {full_scale} " N m: lower it \
                 to that, or scale the amplifier up"),
            Self::Unrepresentable { name, reason } => {
                push!(t, "the " {name} ": ");
                reason.write(&mut t);
            }
            Self::Uncertified { format } => push!(t,
                "the scene is certified, but not with its coefficients rounded to " {format.name().as_str()}
                ": `haptic certify --format` says why; leave more margin"),
            Self::IllPosed { line, contact } => push!(t,
                "coupling and environment have no unique solution: the loop gain 1 + f / K is " {line} " out of \
                 contact and " {contact} " in contact, and must be positive; a stiffer coupling or a delayed \
                 environment has one"),
            Self::NotLate => t.push("the environment says that it is late, and its law is not"),
            Self::Structure => {
                t.push("the scene has other parts, delays or another coupling than this program");
            }
            Self::NoMatchedCoupling => t.push(
                "there is no matched coupling for this latency: actuator lag and sensor lag are too \
                 much alike, updates may be missed where torques lag, or a number is out of range",
            ),
            Self::Turn { counts, largest } => push!(t,
                "a turn has " {counts} " encoder counts, and a torque profile that repeats for ever needs a whole \
                 number of them, up to " {largest} ": give it end stops, or count at the shaft that it is on"),
            Self::Hysteresis { hysteresis, count } => push!(t,
                "from a snap point the knob goes back " {hysteresis} " rad to snap back, and that must be more than \
                 an encoder count of " {count} " rad: put the snap point farther from the centre, or take fewer \
                 detents"),
            Self::LawElsewhere => t.push(
                "the environment is known by its bounds alone: only its own crate renders it",
            ),
            Self::Delay { delay, largest } => push!(t,
                "a delay of " {delay} " samples is longer than the " {largest} " that are stored"),
            Self::Improper { numerator, denominator } => push!(t,
                "a numerator of degree " {numerator} " over a denominator of degree " {denominator}
                " needs future samples"),
            Self::Injection { damping, room } => push!(t,
                "a damping of " {damping} " N m s/rad that is switched on and off needs as much of the device's \
                 passivity, but this scene leaves less than " {room} " N m s/rad: inject less, or make the scene \
                 softer"),
            Self::Returned { energy, largest } => push!(t,
                "a hand that pushes and lets go returns up to " {energy} " J to the supply, which takes less than "
                {largest} " J below its fault level: make the wall stiffer or its torque limit lower, or state a \
                 supply that takes more in the program"),
            Self::Speed { counts, half } => push!(t,
                "at the largest speed the encoder may move by " {counts} " counts between two ticks, but its counter \
                 resolves only fewer than " {half} ": take a shorter worst period or a wider counter"),
            Self::Period { period, shortest, longest } => push!(t,
                "the period of " {period} " s is not between " {shortest} " and " {longest} " s, the range of a board"),
        }
        t
    }
}

error_with_sentence!(BuildError);
