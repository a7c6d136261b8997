//! Why a host's torque is refused.

use crate::text::{Sentence, sentences};

sentences! {
    /// The reason why a scene cannot have this torque from a host beside it.
    HostError: Sentence {
    NotPositive { name: &'static str, value: f64, unit: &'static str } => (
        "the host's " {name} " must be positive and finite, and is " {value} " " {unit}),
    Power { power: f64 } => ("the host's power must be finite and 0 W or more, and is " {power} " W"),
    Share { damping: f64, margin: f64 } => (
        "the host's share of damping is " {damping} " N m s/rad, and must be below the margin of " {margin}
        " N m s/rad, the damping that the scene leaves over: lower the share, or make the scene softer"),
    NoMargin { damping: f64 } => (
        "the host's share of damping is " {damping} " N m s/rad, and the scene has no known margin to take \
         it from: where torques lag, a limited scene behind a coupling has none, and one without a coupling has"),
    Range { torque: f64, limit: f64, full_scale: f64 } => (
        "the host's largest torque of " {torque} " N m and the " {limit} " N m of the scene, its torque limit \
         with what opposes cogging, are together above the full scale of " {full_scale} " N m: lower one of them"),
    Unlimited { torque: f64, full_scale: f64 } => (
        "the scene has no torque limit and takes the full scale of " {full_scale} " N m, which leaves no \
         room for the host's largest torque of " {torque} " N m: limit the scene's torque"),
    /// The bound is the error that the encoder's counts can cause.
    Energy { energy: f64, least: f64 } => (
        "the host's energy is " {energy} " J, and must be above " {least} " J, which the error of the \
         encoder's counts can take at this motor's torque: raise the energy, or take a finer encoder"),
    MostEnergy { energy: f64, most: f64 } => (
        "the host's energy is " {energy} " J, and must be at most " {most} " J, the most that the tank counts in \
         steps of this motor's torque: lower the energy"),
    Torque { torque: f64, least: f64 } => (
        "the host's largest torque is " {torque} " N m, and must be at least " {least} " N m, a code of the DAC"),
    /// The bounds are the steps of a torque in which the tank counts.
    Steps { damping: f64, least: f64, most: f64 } => (
        "the host's share of damping is " {damping} " N m s/rad, and must be at least " {least} " N m s/rad and \
         below " {most} " N m s/rad, so that the tank can count the motion with this encoder, motor and period"),
    Timeout { timeout: f64, least: f64, most: f64 } => (
        "the host's timeout is " {timeout} " s, and must be at least two periods, which are " {least} " s, and at \
         most " {most} " s, as long as the servo counts"),
    Stores => (
        "a hand that works against a host's torque returns energy to the supply of the bridge for as long as it \
         does so, and this supply takes none back: take a supply that sinks, such as one with a brake resistor"),
    NotCovered { time: &'static str } => ("there is no proof for a host's torque beside " {time}),
    }
}

impl HostError {
    #[cfg_attr(target_os = "none", inline(never))]
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
}
