//! Every key of a scene file: its full name, its unit, and the bound on its value.
//!
//! Bounds here are about what a number can mean at all. Whether a scene with these numbers is
//! safe is the certificate's question: a negative stiffness is a bad spring, not a bad file.

use firmware::environment::{MAX_DEGREE, MAX_DELAY};

/// What a number must satisfy. Numbers are finite in every case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Any finite number.
    Finite,
    /// Greater than zero.
    Positive,
    /// Zero or more.
    NotNegative,
    /// At least zero and less than one.
    Fraction,
    /// A whole number from the first to the second, both included.
    Whole(u32, u32),
    /// Not a number at all, but this.
    Other(&'static str),
}

impl Bound {
    /// Whether `value` satisfies the bound.
    pub fn admits(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::Fraction => (0.0..1.0).contains(&value),
                Self::Whole(least, most) => {
                    value.fract() == 0.0 && (f64::from(least)..=f64::from(most)).contains(&value)
                }
                Self::Other(_) => false,
            }
    }

    /// What the value must be, with its unit: ends a sentence that starts with "it must be".
    pub fn requirement(self, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match self {
            Self::Finite => format!("a finite number{}", unit_phrase(&unit)),
            Self::Positive => format!("a finite number greater than 0{unit}"),
            Self::NotNegative => format!("a finite number, 0{unit} or more"),
            Self::Fraction => "a number of at least 0 and less than 1".to_owned(),
            Self::Whole(least, most) => format!("a whole number from {least} to {most}{unit}"),
            Self::Other(text) => text.to_owned(),
        }
    }
}

fn unit_phrase(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in{unit}") }
}

/// A key of the file.
#[derive(Debug, PartialEq)]
pub struct Key {
    /// Full name with the tables it stands in, such as `device.inertia`.
    pub path: &'static str,
    /// Unit of the value, empty for a bare number.
    pub unit: &'static str,
    /// What the value must satisfy.
    pub bound: Bound,
}

impl Key {
    const fn new(path: &'static str, unit: &'static str, bound: Bound) -> Self {
        Self { path, unit, bound }
    }

    /// The name in its own table: what stands in the file.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// What the value must be, with its unit.
    pub fn requirement(&self) -> String {
        self.bound.requirement(self.unit)
    }
}

macro_rules! keys {
    ($($(#[$doc:meta])* $constant:ident = $path:literal, $unit:literal, $bound:expr;)*) => {
        $($(#[$doc])* pub const $constant: Key = Key::new($path, $unit, $bound);)*

        /// All keys, in the order of the documentation.
        pub const ALL: &[&Key] = &[$(&$constant),*];
    };
}

/// Largest degree as the bounds print it.
const DEGREE: u32 = MAX_DEGREE as u32;
/// Longest delay as the bounds print it.
const DELAY: u32 = MAX_DELAY as u32;

const TABLE: Bound = Bound::Other("a table");
const POLYNOMIAL: Bound =
    Bound::Other("a list of 1 to 9 finite numbers, descending powers of z, not all of them 0");
const DELAYED_POLYNOMIAL: Bound = Bound::Other(
    "a list of 1 to 9 finite numbers, descending powers of z, not all of them 0; zeros at its end are \
     delay, and may be 8 more, together with `delay`",
);

keys! {
    /// What the person calls the scene.
    NAME = "name", "", Bound::Other("a string");

    /// The machine that the hand holds.
    DEVICE = "device", "", TABLE;
    /// Inertia, used by simulation.
    INERTIA = "device.inertia", "kg m^2", Bound::Positive;
    /// Viscous damping.
    DEVICE_DAMPING = "device.damping", "N m s/rad", Bound::NotNegative;
    /// Output strict passivity where it is not the damping.
    PASSIVITY = "device.passivity", "N m s/rad", Bound::NotNegative;
    /// Dry friction at the motor.
    DEVICE_FRICTION = "device.friction", "N m", Bound::NotNegative;
    /// Masses of a chain, in place of inertia and damping: first the motor's, last the hand's.
    MASS = "device.mass", "", Bound::Other("a list of 1 to 10 tables");
    /// Inertia of a mass.
    MASS_INERTIA = "device.mass.inertia", "kg m^2", Bound::Positive;
    /// Damping of a mass against the ground.
    MASS_DAMPING = "device.mass.damping", "N m s/rad", Bound::NotNegative;
    /// Links between one mass and the next.
    LINK = "device.link", "", Bound::Other("a list of tables, one fewer than masses");
    /// Stiffness of a link.
    LINK_STIFFNESS = "device.link.stiffness", "N m/rad", Bound::NotNegative;
    /// Damping of a link.
    LINK_DAMPING = "device.link.damping", "N m s/rad", Bound::NotNegative;
    /// Which mass the encoder is on.
    ENCODER = "device.encoder", "", Bound::Other("\"motor\" or \"hand\"");
    /// Time constant of the amplifier.
    ACTUATOR_LAG = "device.actuator_lag", "s", Bound::NotNegative;

    /// When the servo runs.
    SERVO = "servo", "", TABLE;
    /// Nominal period.
    PERIOD = "servo.period", "s", Bound::Positive;
    /// Longest tolerated time between two updates.
    WORST_PERIOD = "servo.worst_period", "s", Bound::Positive;

    /// What connects device and environment; absent, the connection is rigid.
    COUPLING = "coupling", "", TABLE;
    /// Stiffness of the coupling.
    COUPLING_STIFFNESS = "coupling.stiffness", "N m/rad", Bound::Positive;

    /// What the hand shall feel.
    ENVIRONMENT = "environment", "", TABLE;
    /// Which environment.
    TYPE = "environment.type", "", Bound::Other(
        "\"delayed-spring\", \"damper-wall\", \"free-mode\", \"free-mode-wall\" or \"rational\""
    );
    /// Stiffness of a spring or wall.
    STIFFNESS = "environment.stiffness", "N m/rad", Bound::Finite;
    /// Damping of a wall.
    DAMPING = "environment.damping", "N m s/rad", Bound::Finite;
    /// Delay of the force: 1 where it is latched at the next tick, 0 where it is written at once.
    DELAY_SAMPLES = "environment.delay", "samples", Bound::Whole(0, DELAY);
    /// Pole of the velocity filter of a wall.
    FILTER = "environment.filter", "", Bound::Fraction;
    /// Where the wall is at rest, or where it begins.
    FACE = "environment.face", "rad", Bound::Finite;
    /// Whether the wall is felt only beyond its face.
    ONE_SIDED = "environment.one_sided", "", Bound::Other("true or false");
    /// Damping that free mode leaves.
    RESIDUAL = "environment.residual", "N m s/rad", Bound::Finite;
    /// Numerator of a rational environment.
    NUMERATOR = "environment.numerator", "", POLYNOMIAL;
    /// Denominator of a rational environment.
    DENOMINATOR = "environment.denominator", "", DELAYED_POLYNOMIAL;
    /// Zeros at z = 1 that multiply the numerator.
    UNIT_ZEROS = "environment.unit_zeros", "", Bound::Whole(0, DEGREE);

    /// What a simulation starts from.
    SIMULATION = "simulation", "", TABLE;
    /// Number of samples.
    SAMPLES = "simulation.samples", "samples", Bound::Whole(1, 100_000_000);
    /// Position at sample 0.
    POSITION = "simulation.position", "rad", Bound::Finite;
    /// Velocity at sample 0.
    VELOCITY = "simulation.velocity", "rad/s", Bound::Finite;
    /// Torque by the hand, held over each sample.
    TORQUE = "simulation.torque", "", Bound::Other("a list of finite numbers in N m");
    /// The same from a file.
    TORQUE_FILE = "simulation.torque_file", "", Bound::Other("the name of a file");
    /// Sine torque by the hand.
    TORQUE_SINE = "simulation.torque_sine", "", TABLE;
    /// Amplitude of the sine.
    SINE_AMPLITUDE = "simulation.torque_sine.amplitude", "N m", Bound::Finite;
    /// Angular frequency of the sine.
    SINE_OMEGA = "simulation.torque_sine.omega", "rad/s", Bound::NotNegative;
    /// Phase of the sine at sample 0.
    SINE_PHASE = "simulation.torque_sine.phase", "rad", Bound::Finite;
    /// Whether the sine is held over each sample.
    SINE_HELD = "simulation.torque_sine.held", "", Bound::Other("true or false");
    /// Pulses of torque by the hand.
    TORQUE_PULSES = "simulation.torque_pulses", "", TABLE;
    /// Height of the pulses.
    PULSE_AMPLITUDE = "simulation.torque_pulses.amplitude", "N m", Bound::Finite;
    /// From the start of one pulse to the next.
    PULSE_EVERY = "simulation.torque_pulses.every", "samples", Bound::Whole(1, 100_000_000);
    /// How long a pulse lasts.
    PULSE_LENGTH = "simulation.torque_pulses.length", "samples", Bound::Whole(1, 100_000_000);

    /// Dry friction in the simulation, where it is not the device's.
    FRICTION = "simulation.friction", "N m", Bound::NotNegative;
    /// Time from a sample to its torque.
    LATENCY = "simulation.latency", "s", Bound::NotNegative;
    /// Ticks in which the servo does not run.
    MISSED = "simulation.missed", "", TABLE;
    /// Of so many ticks the last is missed.
    MISSED_EVERY = "simulation.missed.every", "ticks", Bound::Whole(2, 1_000_000);
    /// Probability that a tick is missed.
    MISSED_FRACTION = "simulation.missed.fraction", "", Bound::Fraction;
    /// Seed of the chance.
    MISSED_SEED = "simulation.missed.seed", "", Bound::Whole(0, u32::MAX);

    /// A passive hand that holds the device.
    HUMAN = "human", "", TABLE;
    /// Inertia of the hand.
    HUMAN_INERTIA = "human.inertia", "kg m^2", Bound::NotNegative;
    /// Damping of the hand.
    HUMAN_DAMPING = "human.damping", "N m s/rad", Bound::NotNegative;
    /// Stiffness of the hand.
    HUMAN_STIFFNESS = "human.stiffness", "N m/rad", Bound::NotNegative;

    /// Bounds of the hardware.
    LIMITS = "limits", "", TABLE;
    /// Largest coupling torque.
    TORQUE_LIMIT = "limits.torque", "N m", Bound::Positive;
    /// Angle of one encoder count.
    ENCODER_STEP = "limits.encoder_step", "rad", Bound::Positive;
    /// Torque of the motor at the converter's largest code.
    FULL_SCALE = "limits.full_scale", "N m", Bound::Positive;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_bound_admits_what_is_not_finite() {
        for key in ALL {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert!(!key.bound.admits(value), "{}", key.path);
            }
        }
    }

    #[test]
    fn bounds_at_their_edges() {
        assert!(!Bound::Positive.admits(0.0) && Bound::Positive.admits(f64::MIN_POSITIVE));
        assert!(Bound::NotNegative.admits(0.0) && !Bound::NotNegative.admits(-1e-300));
        assert!(Bound::Fraction.admits(0.0) && !Bound::Fraction.admits(1.0));
        let delay = DELAY_SAMPLES.bound;
        assert!(delay.admits(8.0) && !delay.admits(9.0) && !delay.admits(0.5));
    }
}
