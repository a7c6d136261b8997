//! Errors between a certified scene and a servo.

use crate::number::{Format, Number, OutOfRange};
use crate::text::{Sentence, sentences};

sentences! {
    /// The reason why a certified scene cannot run with these transducers in this number format.
    BuildError: Sentence {
    NotPositive { name: &'static str, value: f64 } => (
        "the " {name} " must be positive and finite, and is " {value}),
    TorqueLimit { limit: f64, full_scale: f64 } => (
        "the torque limit of " {limit} " N m is above the DAC's full scale of " {full_scale} " N m: lower it \
         to that, or scale the amplifier up"),
    /// A constant of the scene does not fit the number format.
    Unrepresentable { name: &'static str, reason: OutOfRange } => ("the " {name} ": " {reason}),
    Uncertified { format: Format } => (
        "the scene is certified, but not with its coefficients rounded to " {format.name().as_str()}
        ": `haptic certify --format` says why; leave more margin"),
    /// `1 + f / K_vc` with the environment's slope `f`.
    IllPosed { line: f64, contact: f64 } => (
        "coupling and environment have no unique solution: the loop gain 1 + f / K is " {line} " out of \
         contact and " {contact} " in contact, and must be positive; a stiffer coupling or a delayed \
         environment has one"),
    Delay { delay: usize, largest: usize } => (
        "a delay of " {delay} " samples is longer than the " {largest} " that are stored"),
    /// The law computes a torque from the present position.
    NotLate => ("the environment says that it is late, and its law is not"),
    Structure => ("the scene has other parts, delays or another coupling than this program"),
    NoMatchedCoupling => (
        "there is no matched coupling for this latency: updates may be missed where torques lag, or a number is out of \
         range"),
    Turn { counts: f64, largest: f64 } => (
        "a turn has " {counts} " encoder counts, and a torque profile that repeats for ever needs a whole \
         number of them, up to " {largest} ": give it end stops, or count at the shaft that it is on"),
    Anticogging { torque: f64, limit: f64, full_scale: f64 } => (
        "the " {torque} " N m that oppose the cogging and the scene's limit of " {limit} " N m are together above \
         the DAC's full scale of " {full_scale} " N m, which would clip their sum: lower the torque limit"),
    CoggingMap { found: u32, expected: u32 } => (
        "the cogging map in flash has the checksum " {found} ", and was compiled with " {expected}
        ": flash the program again"),
    Hysteresis { hysteresis: f64, count: f64 } => (
        "from a snap point the knob goes back " {hysteresis} " rad to snap back, and that must be more than \
         an encoder count of " {count} " rad: put the snap point farther from the centre, or take fewer \
         detents"),
    LawElsewhere => ("the environment is known by its bounds alone: only its own crate renders it"),
    /// The degrees; also of a denominator that is zero.
    Improper { numerator: usize, denominator: usize } => (
        "a numerator of degree " {numerator} " over a denominator of degree " {denominator} " needs future samples"),
    Injection { damping: f64, room: f64 } => (
        "a damping of " {damping} " N m s/rad that is switched on and off needs as much of the device's \
         passivity, but this scene leaves less than " {room} " N m s/rad: inject less, or make the scene \
         softer"),
    /// Infinite if no bound is known.
    Returned { energy: f64, largest: f64 } => (
        "a hand that pushes and lets go returns up to " {energy} " J to the supply, which takes less than "
        {largest} " J below its fault level: make the wall stiffer or its torque limit lower, or state a \
         supply that takes more in the program"),
    Speed { counts: f64, half: f64 } => (
        "at the largest speed the encoder may move by " {counts} " counts between two ticks, but its counter \
         resolves only fewer than " {half} ": take a shorter worst period or a wider counter"),
    Period { period: f64, shortest: f64, longest: f64 } => (
        "the period of " {period} " s is not between " {shortest} " and " {longest} " s, the range of a board"),
    }
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
}
