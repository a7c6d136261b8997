//! Every key of a scene file: its full name, its unit, the bound on its value, what counts where it
//! is left out, and an example.
//!
//! Reading, the reference, the JSON schema and the examples are made of this one table; the doc
//! comments in it are the reference's words.
//!
//! Bounds here are about what a number can mean at all. Whether a scene with these numbers is
//! safe is the certificate's question: a negative stiffness is a bad spring, not a bad file.

use firmware::environment::{MAX_DEGREE, MAX_DELAY};

use Presence::{Default, Needed, Optional};

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
    /// Not a number at all, but this, in words that end a sentence.
    Other(Form, &'static str),
}

/// What a value is that is not a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A string.
    Text,
    /// One of these strings; of none, one of the types of environment.
    OneOf(&'static [&'static str]),
    /// `true` or `false`.
    Boolean,
    /// Numbers in a row.
    Numbers,
    /// A table.
    Table,
    /// Tables in a row.
    Tables,
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
                Self::Other(..) => false,
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
            Self::Other(_, text) => text.to_owned(),
        }
    }
}

fn unit_phrase(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in{unit}") }
}

/// Whether a key must be there, and what counts where it is not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// It must be there, wherever its table is.
    Needed,
    /// This number, where it is left out.
    Default(f64),
    /// It may be left out, which means this.
    Optional(&'static str),
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
    /// Whether it must be there.
    pub presence: Presence,
    /// A value as TOML writes it; empty for a table that is written with its header.
    pub example: &'static str,
    /// What it is, in words.
    pub doc: &'static str,
}

impl Key {
    /// A file as a whole, which has no name.
    pub const fn root(requirement: &'static str) -> Self {
        let (bound, presence) = (Bound::Other(Form::Table, requirement), Presence::Needed);
        Self { path: "", unit: "", bound, presence, example: "", doc: "" }
    }

    /// The name in its own table: what stands in the file.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// What the value must be, with its unit.
    pub fn requirement(&self) -> String {
        self.bound.requirement(self.unit)
    }

    /// The path of the table that it stands in; empty for the file itself.
    pub fn table(&self) -> &'static str {
        self.path.rsplit_once('.').map_or("", |(table, _)| table)
    }
}

macro_rules! keys {
    ($($(#[doc = $doc:literal])* $constant:ident = $path:literal, $unit:literal, $bound:expr,
       $presence:expr, $example:literal;)*) => {
        $($(#[doc = $doc])* pub const $constant: Key = Key {
            path: $path,
            unit: $unit,
            bound: $bound,
            presence: $presence,
            example: $example,
            doc: concat!($($doc),*).trim_ascii(),
        };)*

        /// All keys, in the order of the documentation.
        pub const ALL: &[&Key] = &[$(&$constant),*];
    };
}

/// Largest degree as the bounds print it.
const DEGREE: u32 = MAX_DEGREE as u32;
/// Longest delay as the bounds print it.
const DELAY: u32 = MAX_DELAY as u32;

const TABLE: Bound = Bound::Other(Form::Table, "a table");
const POLYNOMIAL: Bound = Bound::Other(
    Form::Numbers,
    "a list of 1 to 9 finite numbers, descending powers of z, not all of them 0",
);
const DELAYED_POLYNOMIAL: Bound = Bound::Other(
    Form::Numbers,
    "a list of 1 to 9 finite numbers, descending powers of z, not all of them 0; zeros at its end are \
     delay, and may be 8 more, together with `delay`",
);

keys! {
    /// Name of the scene, as reports and pictures show it.
    NAME = "name", "", Bound::Other(Form::Text, "a string"),
        Needed, "\"a wall\"";

    /// The machine that the hand holds.
    DEVICE = "device", "", TABLE,
        Needed, "";
    /// Inertia of a rigid device. The certificate does not use it; simulations do.
    INERTIA = "device.inertia", "kg m^2", Bound::Positive,
        Needed, "2.2e-5";
    /// Viscous damping of a rigid device.
    DEVICE_DAMPING = "device.damping", "N m s/rad", Bound::NotNegative,
        Needed, "0.022";
    /// Passivity `delta` of the device from torque to velocity, where less of it is to be counted on.
    PASSIVITY = "device.passivity", "N m s/rad", Bound::NotNegative,
        Optional("the device's damping; of a chain, what is computed for it"), "0.0219";
    /// Dry (Coulomb) friction at the motor.
    DEVICE_FRICTION = "device.friction", "N m", Bound::NotNegative,
        Optional("none that is counted on: the verdict does not say whether the device comes to rest"), "0.003";
    /// Masses of a chain, in place of inertia and damping: the motor's first, the hand's last.
    MASS = "device.mass", "", Bound::Other(Form::Tables, "a list of 1 to 10 tables"),
        Optional("one rigid body, of `device.inertia` and `device.damping`"), "";
    /// Inertia of this mass.
    MASS_INERTIA = "device.mass.inertia", "kg m^2", Bound::Positive,
        Needed, "2.0e-5";
    /// Viscous damping between this mass and the ground.
    MASS_DAMPING = "device.mass.damping", "N m s/rad", Bound::NotNegative,
        Default(0.0), "0.02";
    /// Shafts or cables of a chain: the first joins the first two masses.
    LINK = "device.link", "", Bound::Other(Form::Tables, "a list of tables, one fewer than masses"),
        Optional("none, which one mass needs"), "";
    /// Stiffness of this link. With no stiffness it must have damping.
    LINK_STIFFNESS = "device.link.stiffness", "N m/rad", Bound::NotNegative,
        Needed, "40.0";
    /// Viscous damping along this link.
    LINK_DAMPING = "device.link.damping", "N m s/rad", Bound::NotNegative,
        Default(0.0), "0.015";
    /// Which end of the chain the encoder is on. At the hand's end of a flexible chain the device has
    /// no passivity, and nothing certifies.
    ENCODER = "device.encoder", "", Bound::Other(Form::OneOf(&["motor", "hand"]), "\"motor\" or \"hand\""),
        Optional("\"motor\""), "\"motor\"";
    /// Time constant of the amplifier's first-order lag. A device with one has no passivity, and
    /// nothing certifies; `simulate`, `stability` and `device` take it.
    ACTUATOR_LAG = "device.actuator_lag", "s", Bound::NotNegative,
        Default(0.0), "0.0";

    /// When the servo runs.
    SERVO = "servo", "", TABLE,
        Needed, "";
    /// Time from one update of the torque to the next.
    PERIOD = "servo.period", "s", Bound::Positive,
        Needed, "0.001";
    /// Longest tolerated time between two updates, not less than the period.
    WORST_PERIOD = "servo.worst_period", "s", Bound::Positive,
        Optional("the period: no update may be missed"), "0.001";

    /// The virtual spring between device and environment.
    COUPLING = "coupling", "", TABLE,
        Optional("the connection is rigid"), "";
    /// Its stiffness. The paper's is twice the passivity over the period.
    COUPLING_STIFFNESS = "coupling.stiffness", "N m/rad", Bound::Positive,
        Needed, "44.0";

    /// What the hand shall feel.
    ENVIRONMENT = "environment", "", TABLE,
        Needed, "";
    /// Which environment.
    TYPE = "environment.type", "", Bound::Other(
        Form::OneOf(&[]),
        "\"delayed-spring\", \"damper-wall\", \"free-mode\", \"free-mode-wall\" or \"rational\""
    ),
        Needed, "\"damper-wall\"";
    /// Stiffness of the spring or wall.
    STIFFNESS = "environment.stiffness", "N m/rad", Bound::Finite,
        Needed, "20.0";
    /// Damping of the wall.
    DAMPING = "environment.damping", "N m s/rad", Bound::Finite,
        Needed, "0.005";
    /// Delay from a sample to its torque: 1 where the torque is latched at the next tick, as on every
    /// board; 0 where it is written at once.
    DELAY_SAMPLES = "environment.delay", "samples", Bound::Whole(0, DELAY),
        Default(0.0), "1";
    /// Pole of the low-pass filter on the wall's velocity; 0 filters nothing.
    FILTER = "environment.filter", "", Bound::Fraction,
        Optional("no filter"), "0.1";
    /// Angle at which the wall is at rest, or where it begins.
    FACE = "environment.face", "rad", Bound::Finite,
        Default(0.0), "0.05";
    /// Whether the wall is felt only beyond its face.
    ONE_SIDED = "environment.one_sided", "", Bound::Other(Form::Boolean, "true or false"),
        Optional("false: the wall pulls as well as it pushes"), "true";
    /// Damping that free mode leaves in the hand.
    RESIDUAL = "environment.residual", "N m s/rad", Bound::Finite,
        Needed, "0.018";
    /// Numerator of the environment, from position to torque.
    NUMERATOR = "environment.numerator", "", POLYNOMIAL,
        Needed, "[5.0, -2.0]";
    /// Denominator of the environment.
    DENOMINATOR = "environment.denominator", "", DELAYED_POLYNOMIAL,
        Needed, "[1.0, -0.3, 0.1, 0.0]";
    /// Zeros at z = 1 that multiply the numerator. With them its degree is at most 8.
    UNIT_ZEROS = "environment.unit_zeros", "", Bound::Whole(0, DEGREE),
        Default(0.0), "0";

    /// What a simulation starts from, and the torque of the hand. `run` does not read it.
    SIMULATION = "simulation", "", TABLE,
        Optional("nothing that `simulate` could start from"), "";
    /// Number of samples.
    SAMPLES = "simulation.samples", "samples", Bound::Whole(1, 100_000_000),
        Needed, "2000";
    /// Position at sample 0.
    POSITION = "simulation.position", "rad", Bound::Finite,
        Default(0.0), "0.001";
    /// Velocity at sample 0.
    VELOCITY = "simulation.velocity", "rad/s", Bound::Finite,
        Default(0.0), "0.1";
    /// Torque of the hand, a value a sample, held over it; none after the last. The hand has one of
    /// `torque`, `torque_file`, `torque_sine` and `torque_pulses`.
    TORQUE = "simulation.torque", "", Bound::Other(Form::Numbers, "a list of finite numbers in N m"),
        Optional("no torque of this kind"), "[0.1, 0.2]";
    /// The same in a file, one number a line; its name is relative to the scene file.
    TORQUE_FILE = "simulation.torque_file", "", Bound::Other(Form::Text, "the name of a file"),
        Optional("no torque of this kind"), "\"push.csv\"";
    /// A sine torque of the hand.
    TORQUE_SINE = "simulation.torque_sine", "", TABLE,
        Optional("no torque of this kind"), "{ amplitude = 0.01, omega = 60.0 }";
    /// Amplitude of the sine.
    SINE_AMPLITUDE = "simulation.torque_sine.amplitude", "N m", Bound::Finite,
        Needed, "0.01";
    /// Angular frequency of the sine.
    SINE_OMEGA = "simulation.torque_sine.omega", "rad/s", Bound::NotNegative,
        Needed, "60.0";
    /// Phase of the sine at sample 0.
    SINE_PHASE = "simulation.torque_sine.phase", "rad", Bound::Finite,
        Default(0.0), "0.5";
    /// Whether the sine is held over each sample.
    SINE_HELD = "simulation.torque_sine.held", "", Bound::Other(Form::Boolean, "true or false"),
        Optional("false: continuous in time"), "true";
    /// Pulses of the hand's torque.
    TORQUE_PULSES = "simulation.torque_pulses", "", TABLE,
        Optional("no torque of this kind"), "{ amplitude = 0.1, every = 500, length = 250 }";
    /// Height of the pulses.
    PULSE_AMPLITUDE = "simulation.torque_pulses.amplitude", "N m", Bound::Finite,
        Needed, "0.1";
    /// From the start of one pulse to the start of the next.
    PULSE_EVERY = "simulation.torque_pulses.every", "samples", Bound::Whole(1, 100_000_000),
        Needed, "500";
    /// How long a pulse lasts.
    PULSE_LENGTH = "simulation.torque_pulses.length", "samples", Bound::Whole(1, 100_000_000),
        Needed, "250";

    /// Dry friction in the simulation, where it is not that of the device.
    FRICTION = "simulation.friction", "N m", Bound::NotNegative,
        Optional("`device.friction`, or none"), "0.002";
    /// Time from a sample to its torque, less than the period.
    LATENCY = "simulation.latency", "s", Bound::NotNegative,
        Default(0.0), "0.0002";
    /// Ticks in which the servo does not run: every so many, or by chance.
    MISSED = "simulation.missed", "", TABLE,
        Optional("none is missed"), "{ fraction = 0.01, seed = 1 }";
    /// Of so many ticks the last is missed.
    MISSED_EVERY = "simulation.missed.every", "ticks", Bound::Whole(2, 1_000_000),
        Optional("`simulation.missed.fraction` decides"), "2";
    /// Probability that a tick is missed.
    MISSED_FRACTION = "simulation.missed.fraction", "", Bound::Fraction,
        Optional("`simulation.missed.every` decides"), "0.01";
    /// Seed of the chance: the same seed misses the same ticks.
    MISSED_SEED = "simulation.missed.seed", "", Bound::Whole(0, u32::MAX),
        Default(0.0), "1";

    /// A passive hand that holds the device, for `simulate`, `stability` and `run`.
    HUMAN = "human", "", TABLE,
        Optional("nobody holds the device; in `run`, the hand of the demonstration"), "";
    /// Inertia of the hand.
    HUMAN_INERTIA = "human.inertia", "kg m^2", Bound::NotNegative,
        Default(0.0), "1e-4";
    /// Damping of the hand.
    HUMAN_DAMPING = "human.damping", "N m s/rad", Bound::NotNegative,
        Default(0.0), "0.02";
    /// Stiffness of the hand.
    HUMAN_STIFFNESS = "human.stiffness", "N m/rad", Bound::NotNegative,
        Default(0.0), "6.0";

    /// Bounds of the hardware.
    LIMITS = "limits", "", TABLE,
        Optional("no limits"), "";
    /// Largest torque that the servo gives; it becomes part of what is certified.
    TORQUE_LIMIT = "limits.torque", "N m", Bound::Positive,
        Optional("no limit: what is certified is the linear loop, and a board refuses it where only that passes"), "1.0";
    /// Angle of one encoder count.
    ENCODER_STEP = "limits.encoder_step", "rad", Bound::Positive,
        Optional("not known: nothing is said of rest, and `run` takes 65536 counts a turn"), "1e-4";
    /// Torque of the motor at the largest code of the DAC.
    FULL_SCALE = "limits.full_scale", "N m", Bound::Positive,
        Optional("not known: `run` takes the torque limit, or 5 N m"), "2.0";
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
