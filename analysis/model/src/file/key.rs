//! Every key of a scene file: its full name, unit, bound, the default or the meaning of leaving it out, and
//! an example.
//!
//! The reader, the reference, the JSON schema and the examples use this one table; the doc comments in it are
//! the text of the reference.
//!
//! A bound here excludes numbers that have no meaning at all. Whether a scene with these numbers is safe is
//! decided by the certificate: a negative stiffness is a bad spring, not a bad file.

use std::f64::consts::TAU;

use haptic_servo::magnetic::Chip;
use haptic_servo::parameter::{Parameter, Range};

use Presence::{Default, Needed, Optional};

/// The bound of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// A number in this range. Numbers are finite in every case.
    Number(Range),
    /// Another form than a number, with its requirement as the end of a sentence.
    Other(Form, &'static str),
}

/// The form of a value that is not a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A string.
    Text,
    /// One of these strings; an empty list stands for the types of environment or of shape.
    OneOf(&'static [&'static str]),
    /// `true` or `false`.
    Boolean,
    /// A list of numbers.
    Numbers,
    /// A list of pairs of numbers.
    Pairs,
    /// A list of second-order sections.
    Sections,
    /// A list of real or complex numbers.
    Roots,
    /// A table.
    Table,
    /// A list of tables.
    Tables,
    /// A list of tables, or one of them.
    TablesOrOne,
    /// A time, or the two ends of the range in which it is known to lie.
    Time,
}

impl Bound {
    /// Whether `value` satisfies the bound.
    pub fn admits(self, value: f64) -> bool {
        matches!(self, Self::Number(range) if range.admits(value))
    }

    /// The requirement on the value, with its unit: ends a sentence that starts with "it must be".
    pub fn requirement(self, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match self {
            Self::Number(Range::Finite) => format!("a finite number{}", unit_phrase(&unit)),
            Self::Number(Range::Positive) => format!("a finite number greater than 0{unit}"),
            Self::Number(Range::NotNegative) => format!("a finite number, 0{unit} or more"),
            Self::Number(Range::Share) => "a number from 0 to 1".to_owned(),
            Self::Number(Range::Fraction) => "a number of at least 0 and less than 1".to_owned(),
            Self::Number(Range::Whole(least, most)) => {
                format!("a whole number from {least} to {most}{unit}")
            }
            Self::Other(_, text) => text.to_owned(),
        }
    }
}

fn unit_phrase(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in{unit}") }
}

/// Whether a key is required, and its default or meaning if it is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// Required wherever its table is present.
    Needed,
    /// This number, if the key is left out.
    Default(f64),
    /// It may be left out, with this meaning.
    Optional(&'static str),
}

/// A key of the file.
#[derive(Debug, PartialEq)]
pub struct Key {
    /// Full name with the tables it stands in, such as `device.inertia`.
    pub path: &'static str,
    /// Unit of the value, empty for a bare number.
    pub unit: &'static str,
    /// The bound of the value.
    pub bound: Bound,
    /// Whether the key is required.
    pub presence: Presence,
    /// A value as TOML writes it; empty for a table that is written with its header.
    pub example: &'static str,
    /// Description.
    pub doc: &'static str,
    /// The parameter of a scene that it sets, if it is one.
    pub parameter: Option<Parameter>,
}

impl Key {
    /// A file as a whole, which has no name.
    pub const fn root(requirement: &'static str) -> Self {
        let (bound, presence) = (Bound::Other(Form::Table, requirement), Presence::Needed);
        Self { path: "", unit: "", bound, presence, example: "", doc: "", parameter: None }
    }

    /// The name in its own table, as the file has it.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// The requirement on the value, with its unit.
    pub fn requirement(&self) -> String {
        self.bound.requirement(self.unit)
    }

    /// The path of its table; empty for the file itself.
    pub fn table(&self) -> &'static str {
        self.path.rsplit_once('.').map_or("", |(table, _)| table)
    }
}

/// A key of a scene's parameter, with the name, unit and bound of the firmware.
const fn of(parameter: Parameter) -> Key {
    Key {
        path: parameter.key(),
        unit: parameter.name_and_unit().1,
        parameter: Some(parameter),
        ..other("", "", Bound::Number(parameter.range()))
    }
}

/// A key of the wall beside a torque profile, with unit and bound of a wall's parameter.
const fn of_wall(path: &'static str, parameter: Parameter) -> Key {
    Key { path, parameter: None, ..of(parameter) }
}

/// A key that is not a parameter of the firmware.
const fn other(path: &'static str, unit: &'static str, bound: Bound) -> Key {
    let presence = Presence::Needed;
    Key { path, unit, bound, presence, example: "", doc: "", parameter: None }
}

macro_rules! keys {
    ($($(#[doc = $doc:literal])* $constant:ident = $key:expr, $presence:expr, $example:literal;)*) => {
        $($(#[doc = $doc])* pub const $constant: Key = Key {
            presence: $presence,
            example: $example,
            doc: concat!($($doc),*).trim_ascii(),
            ..$key
        };)*

        /// All keys, in the order of the documentation.
        pub const ALL: &[&Key] = &[$(&$constant),*];
    };
}

const FINITE: Bound = Bound::Number(Range::Finite);
const POSITIVE: Bound = Bound::Number(Range::Positive);
const NOT_NEGATIVE: Bound = Bound::Number(Range::NotNegative);
const FRACTION: Bound = Bound::Number(Range::Fraction);

const fn whole(least: u32, most: u32) -> Bound {
    Bound::Number(Range::Whole(least, most))
}

const TIME: Bound = Bound::Other(
    Form::Time,
    "a finite number, 0 s or more, or a list of two, [least, most], where only the range is known",
);
const TABLE: Bound = Bound::Other(Form::Table, "a table");
const BOOLEAN: Bound = Bound::Other(Form::Boolean, "true or false");
const POLYNOMIAL: Bound = Bound::Other(
    Form::Numbers,
    "a list of 1 to 9 finite numbers, descending powers of z, not all of them 0",
);
const DELAYED_POLYNOMIAL: Bound = Bound::Other(
    Form::Numbers,
    "a list of 1 to 9 finite numbers, descending powers of z, not all of them 0; zeros at its end are \
     delay, and may be 8 more, together with `delay`",
);

const SECOND_ORDER: Bound = Bound::Other(
    Form::Sections,
    "a list of lists of six finite numbers, [b0, b1, b2, a0, a1, a2], a0 not 0, with at most 8 poles in all",
);
const ROOTS: Bound = Bound::Other(
    Form::Roots,
    "a list of up to 8 finite numbers or pairs, [real part, imaginary part], with the conjugate of each",
);

const KNOTS_IN_ORDER: Bound = Bound::Other(
    Form::Pairs,
    "a list of 2 to 2048 pairs, [angle in rad, torque in N m], the angles in rising order",
);

keys! {
    /// Name of the scene, as reports and pictures show it.
    NAME = other("name", "", Bound::Other(Form::Text, "a string")), Needed, "\"a wall\"";

    /// The machine that the hand holds. In place of this table, `device = "knob.toml"` at the top names a file
    /// that has it, and that may have `[limits]`, `[supply]` and `[motor]`, too; each of their keys is in one of both files.
    /// The name is relative to the scene file; of standard input or a line of a batch, to the working folder.
    DEVICE = other("device", "", Bound::Other(Form::Table, "a table, or the name of a device file")), Needed, "";
    /// Inertia of a rigid device. The certificate does not use it; simulations do.
    INERTIA = of(Parameter::Inertia), Needed, "2.2e-5";
    /// Viscous damping of a rigid device.
    DEVICE_DAMPING = of(Parameter::DeviceDamping), Needed, "0.022";
    /// Passivity `delta` of the device from torque to velocity, if a smaller value is to be used.
    PASSIVITY = Key { bound: NOT_NEGATIVE, ..of(Parameter::Passivity) },
        Optional("the device's damping; of a chain, its computed passivity"), "0.0219";
    /// Dry (Coulomb) friction at the motor.
    DEVICE_FRICTION = other("device.friction", "N m", NOT_NEGATIVE),
        Optional("not counted on: the verdict does not say whether the device comes to rest"), "0.003";
    /// Cogging of the motor, for simulation: a torque of `-torque` times the sine of `count` times the angle and
    /// `phase`, or a list of such harmonics. The certificate needs no number of it, because it takes no energy in
    /// a turn.
    COGGING = other("device.cogging", "", Bound::Other(Form::TablesOrOne, "a table, or a list of tables")),
        Optional("no cogging"), "{ torque = 0.005, count = 84 }";
    /// Amplitude of this harmonic.
    COGGING_TORQUE = other("device.cogging.torque", "N m", NOT_NEGATIVE), Needed, "0.005";
    /// Its periods in a turn, mostly the least common multiple of slots and poles: 84 of 12 and 14.
    COGGING_COUNT = other("device.cogging.count", "", whole(1, 4096)), Needed, "84";
    /// Its phase at the angle 0.
    COGGING_PHASE = other("device.cogging.phase", "rad", FINITE), Default(0.0), "0.0";
    /// Masses of a chain, in place of inertia and damping: the motor's first, the hand's last.
    MASS = other("device.mass", "", Bound::Other(Form::Tables, "a list of 1 to 10 tables")),
        Optional("one rigid body, of `device.inertia` and `device.damping`"), "";
    /// Inertia of this mass.
    MASS_INERTIA = other("device.mass.inertia", "kg m^2", POSITIVE), Needed, "2.0e-5";
    /// Viscous damping between this mass and the ground.
    MASS_DAMPING = other("device.mass.damping", "N m s/rad", NOT_NEGATIVE), Default(0.0), "0.02";
    /// Shafts or cables of a chain: the first joins the first two masses.
    LINK = other("device.link", "", Bound::Other(Form::Tables, "a list of tables, one fewer than masses")),
        Optional("none, which one mass needs"), "";
    /// Stiffness of this link. With no stiffness it must have damping.
    LINK_STIFFNESS = other("device.link.stiffness", "N m/rad", NOT_NEGATIVE), Needed, "40.0";
    /// Viscous damping along this link.
    LINK_DAMPING = other("device.link.damping", "N m s/rad", NOT_NEGATIVE), Default(0.0), "0.015";
    /// Which end of the chain the encoder is on. At the hand's end of a flexible chain the device has
    /// no passivity, and nothing certifies.
    ENCODER = other("device.encoder", "", Bound::Other(Form::OneOf(&["motor", "hand"]), "\"motor\" or \"hand\"")),
        Optional("\"motor\""), "\"motor\"";
    /// Time constant of the amplifier, a first-order lag of at most 100 periods. It counts as the
    /// controller's: the device's passivity is that without it. Simulations take the middle of a range.
    ACTUATOR_LAG = Key { bound: TIME, ..of(Parameter::ActuatorLag) },
        Default(0.0), "[5.0e-5, 8.0e-5]";
    /// Time constant of a first-order filter between encoder and servo, in the same way.
    SENSOR_LAG = Key { bound: TIME, ..of(Parameter::SensorLag) }, Default(0.0), "2.0e-5";

    /// In place of `actuator_lag`, of an amplifier whose step response never falls: when it begins and when
    /// it has ended, at most a period; any shape between is covered.
    ACTUATOR_RESPONSE = Key { bound: TIME, ..of(Parameter::ActuatorResponse) },
        Default(0.0), "[2.0e-5, 2.5e-4]";

    /// How often in a period the amplifier's current loop is updated, a whole number of times: the torque is
    /// what the lag makes of a step at each update, and goes in a straight line between two. The output delay
    /// is then a whole number of the times between updates, mostly one; 0: the lag is continuous.
    ACTUATOR_UPDATES = other("device.actuator_updates", "", whole(0, u16::MAX as u32)),
        Default(0.0), "4";

    /// The encoder's readings, where they are not those of a quadrature encoder with a perfect disk; a device
    /// file may have this table, too. A magnetic encoder reads an older position, and its error over the angle
    /// has a slope.
    READING = other("encoder", "", TABLE), Optional("a quadrature encoder with a perfect disk: all is 0"), "";
    /// Counts of the encoder in a turn, in place of `limits.counts_per_turn`, which states them behind a gear.
    READING_COUNTS = other("encoder.counts_per_turn", "counts", whole(1, u32::MAX)),
        Optional("`[limits]` states them"), "16384.0";
    /// The chip of a magnetic absolute encoder that the board reads, with its angle as the position of the device's
    /// axis. Its counts need not be stated; the age and the lag must cover the chip's, which docs/encoders.md lists.
    CHIP = other("encoder.chip", "", Bound::Other(Form::OneOf(&Chip::NAMES), "the name of a chip")),
        Optional("a quadrature encoder"), "\"mt6701\"";
    /// Age of a reading at the instant of its count: the delay of the chip and the time from its last
    /// conversion. With two numbers it is anywhere between them in each tick.
    AGE = Key { bound: TIME, ..of(Parameter::Age) }, Default(0.0), "[0.0, 1.0e-5]";
    /// Length of the window before that age over whose positions a reading is the mean, at most a period.
    WINDOW = of(Parameter::Window), Default(0.0), "4.0e-5";
    /// Time constant of a first-order filter in the encoder, in place of `device.sensor_lag`.
    READING_LAG = other("encoder.lag", "s", TIME), Default(0.0), "6.4e-5";
    /// Whether the encoder predicts the position from the velocity: then nothing certifies.
    PREDICTION = other("encoder.prediction", "", BOOLEAN), Optional("false"), "false";
    /// Largest slope of the angle's error over the angle, `eta`: with an integral nonlinearity (INL) of up to
    /// E rad to either side and mostly of one or two periods a turn, about 2 E.
    LINEARITY = of(Parameter::Linearity), Default(0.0), "0.028";
    /// Peak of the noise of a reading.
    NOISE = of(Parameter::Noise), Default(0.0), "2.0";
    /// Hysteresis of the encoder.
    HYSTERESIS = of(Parameter::Hysteresis), Default(0.0), "0.0";
    /// Readings in a row that may fail their check. The reading before takes their place, and more are a fault.
    /// With a damper or a coupling the torque is held meanwhile: `servo.worst_period` is then as much longer.
    DROPPED = of(Parameter::Dropped), Default(0.0), "1";

    /// The motor's learnt cogging, which the servo opposes outside of the coupling; a device file may have this table,
    /// too. What opposes it takes a part of the passivity, and the scene certifies with the rest.
    ANTICOGGING = other("anticogging", "", TABLE), Optional("nothing opposes the cogging"), "";
    /// Cogging torque, positive in the direction of the angle, at equally spaced angles of a turn of the encoder, the
    /// first at its zero. Their learnt mean is kept.
    ANTICOGGING_TORQUE = other("anticogging.torque", "N m", Bound::Other(
        Form::Numbers,
        "a list of finite numbers in N m, a power of two of them from 8 to 65536, not all of them 0"
    )),
        Needed, "[0.0, -0.002, 0.0, 0.002, 0.0, -0.002, 0.0, 0.002]";
    /// Share of it that the servo opposes.
    ANTICOGGING_SHARE = of(Parameter::Anticogging), Default(1.0), "1.0";

    /// When the servo runs.
    SERVO = other("servo", "", TABLE), Needed, "";
    /// Time from one update of the torque to the next; `rate` may be there in its place.
    PERIOD = of(Parameter::Period), Needed, "0.001";
    /// Updates of the torque in a second, in place of the period.
    RATE = other("servo.rate", "Hz", POSITIVE), Optional("`servo.period` states it"), "1000.0";
    /// Longest tolerated time between two updates, not less than the period.
    WORST_PERIOD = Key { bound: POSITIVE, ..of(Parameter::WorstPeriod) },
        Optional("the period: no update may be missed"), "0.001";
    /// Time from a count to its torque, at most 8 periods, in addition to `environment.delay`.
    OUTPUT_DELAY = Key { bound: TIME, ..of(Parameter::OutputDelay) },
        Default(0.0), "[4.0e-6, 6.0e-6]";
    /// Largest deviation from that delay, to either side, which may differ from tick to tick. Not more
    /// than the delay, or than that and a period where the environment is late and the amplifier lags.
    /// Simulations leave it out.
    OUTPUT_JITTER = of(Parameter::OutputJitter), Default(0.0), "0.0";
    /// Largest deviation of a count from its time, to either side, where torques deviate by
    /// `output_jitter` at the same time; the sum of both is less than half a period. With one of the two at 0
    /// the other is that of torques or of counts.
    COUNT_JITTER = of(Parameter::CountJitter), Default(0.0), "0.0";

    /// Coupling of device and environment.
    COUPLING = other("coupling", "", TABLE), Optional("the connection is rigid"), "";
    /// A spring, or the coupling that absorbs delays and lags: its numbers follow from period,
    /// passivity, delay and lags, and behind it a passive environment stays passive.
    COUPLING_TYPE = other("coupling.type", "", Bound::Other(Form::OneOf(&["spring", "matched"]), "\"spring\" or \"matched\"")),
        Optional("\"spring\""), "\"spring\"";
    /// Stiffness of the spring. The paper's is twice the passivity over the period. A matched coupling
    /// takes none.
    COUPLING_STIFFNESS = of(Parameter::CouplingStiffness),
        Optional("an error with a spring"), "44.0";

    /// The environment that the hand feels.
    ENVIRONMENT = other("environment", "", TABLE), Needed, "";
    /// Which environment.
    TYPE = other("environment.type", "", Bound::Other(
        Form::OneOf(&[]),
        "\"delayed-spring\", \"damper-wall\", \"free-mode\", \"free-mode-wall\", \"rational\", \"sections\", \
         \"zeros-poles-gain\" or \"profile\""
    )),
        Needed, "\"damper-wall\"";
    /// Stiffness of the spring or wall; of a torque profile, that beyond its end stops.
    STIFFNESS = of(Parameter::Stiffness), Needed, "20.0";
    /// Damping of the wall, or of a damper beside the torque profile.
    DAMPING = of(Parameter::Damping), Needed, "0.005";
    /// Delay from a sample to its torque: 1 where the torque is latched at the next tick, as on every
    /// board; 0 where it is written at once.
    DELAY_SAMPLES = of(Parameter::Delay), Default(0.0), "1";
    /// Pole of the low-pass filter on the wall's velocity; 0 filters nothing.
    FILTER = of(Parameter::Filter), Optional("no filter"), "0.1";
    /// Angle at which the wall is at rest, or where it begins.
    FACE = of(Parameter::Face), Default(0.0), "0.05";
    /// Whether the wall is felt only beyond its face.
    ONE_SIDED = other("environment.one_sided", "", BOOLEAN),
        Optional("false: the wall pulls as well as it pushes"), "true";
    /// Damping that free mode leaves in the hand; beside a torque profile, of an undelayed one, if it is
    /// there.
    RESIDUAL = of(Parameter::Residual), Needed, "0.018";
    /// Damping of a damper that acts everywhere, also out of contact with a wall, as late as the environment's
    /// `delay`.
    DRAG = of(Parameter::Drag), Optional("no such damper"), "0.001";
    /// Numerator of the environment, from position to torque.
    NUMERATOR = other("environment.numerator", "", POLYNOMIAL), Needed, "[5.0, -2.0]";
    /// Denominator of the environment.
    DENOMINATOR = other("environment.denominator", "", DELAYED_POLYNOMIAL),
        Needed, "[1.0, -0.3, 0.1, 0.0]";
    /// Zeros at z = 1 that multiply the numerator. With them its degree is at most 8.
    UNIT_ZEROS = of(Parameter::UnitZeros), Default(0.0), "0";
    /// Second-order sections whose product is the environment, each `(b0 + b1/z + b2/z^2)/(a0 + a1/z +
    /// a2/z^2)`, as design tools of filters print them. A first-order section has `b2` and `a2` of 0. The
    /// servo runs the product: one numerator and one denominator, each coefficient rounded once.
    SECTIONS = other("environment.sections", "", SECOND_ORDER),
        Needed, "[[0.0025, 0.005, 0.0025, 1.0, -1.6, 0.65], [1.0, 0.0, 0.0, 1.0, -0.5, 0.0]]";
    /// Zeros of the environment: `gain` times the product of all `z - zero`, over that of all `z - pole`. The
    /// servo runs numerator and denominator, each coefficient rounded once.
    ZEROS = other("environment.zeros", "", ROOTS), Needed, "[-1.0, -1.0]";
    /// Poles of the environment, at least as many as zeros.
    POLES = other("environment.poles", "", ROOTS), Needed, "[[0.8, 0.1], [0.8, -0.1]]";
    /// Factor of the environment's zeros and poles.
    GAIN = other("environment.gain", "", Bound::Number(Range::Finite)), Needed, "0.005";
    /// Knots of a torque profile, joined by straight lines; a positive torque pushes back from a positive
    /// angle. They add to the shapes.
    KNOTS = other("environment.knots", "", KNOTS_IN_ORDER),
        Optional("the shapes are all"), "[[0.0, 0.0], [0.1, 0.02], [0.3, -0.02], [0.4, 0.0]]";
    /// Period of the knots, which their last one closes with the torque of the first; a whole number of
    /// them is a turn, unless there are end stops.
    KNOTS_PERIOD = other("environment.period", "rad", POSITIVE),
        Optional("the knots do not repeat, and end stops hold the angle within their range"), "0.4";
    /// Largest torque of the profile: all torques in proportion, but not the end stops.
    PROFILE_TORQUE = of(Parameter::ProfileTorque), Optional("the sum of shapes and knots"), "0.05";
    /// How often the profile repeats in a turn.
    COUNT = of(Parameter::Count), Optional("the common count of shapes and knots"), "24";
    /// Angle at which the first repetition begins.
    CENTRE = of(Parameter::Centre), Optional("that of the first detents, or 0"), "0.0";
    /// Lower end stop.
    FROM = of(Parameter::From), Optional("that of the shapes, or no end stops"), "-2.618";
    /// Upper end stop.
    TO = of(Parameter::To), Optional("that of the shapes, or no end stops"), "2.618";
    /// Number of equal cells, each a straight line, of the table that shapes and knots become: a power of
    /// two.
    CELLS = other("environment.cells", "", whole(16, 4096)),
        Optional("the fewest that show every straight piece"), "64";
    /// A wall beside the torque profile, at the same angle; the profile then has end stops.
    WALL = other("environment.wall", "", TABLE), Optional("no wall stands beside the profile"), "";
    /// Stiffness of this wall.
    WALL_STIFFNESS = of_wall("environment.wall.stiffness", Parameter::Stiffness), Needed, "10.0";
    /// Damping of this wall.
    WALL_DAMPING = of_wall("environment.wall.damping", Parameter::Damping), Default(0.0), "0.002";
    /// Delay of this wall, as `environment.delay`; it need not be the profile's.
    WALL_DELAY = of_wall("environment.wall.delay", Parameter::Delay), Needed, "1";
    /// Pole of the low-pass filter on this wall's velocity; 0 filters nothing.
    WALL_FILTER = of_wall("environment.wall.filter", Parameter::Filter),
        Optional("no filter"), "0.1";
    /// Angle at which this wall is at rest, or where it begins.
    WALL_FACE = of_wall("environment.wall.face", Parameter::Face), Default(0.0), "1.5";
    /// Whether this wall is felt only beyond its face.
    WALL_ONE_SIDED = other("environment.wall.one_sided", "", BOOLEAN),
        Optional("false: the wall pulls as well as it pushes"), "true";
    /// Named shapes of a torque profile, which add up.
    SHAPE = other("environment.shape", "", Bound::Other(Form::Tables, "a list of 1 to 16 tables")),
        Optional("the knots are all"), "";
    /// Which shape.
    SHAPE_TYPE = other("environment.shape.type", "", Bound::Other(
        Form::OneOf(&[]),
        "\"detents\", \"end_stops\", \"centre\", \"bistable\", \"texture\", \"magnet\" or \"table\""
    )),
        Needed, "\"detents\"";
    /// Number of detents in a turn.
    SHAPE_COUNT = other("environment.shape.count", "", whole(1, 4096)), Needed, "24";
    /// Largest torque of the shape.
    SHAPE_TORQUE = other("environment.shape.torque", "N m", POSITIVE), Needed, "0.05";
    /// Angle of the first detent.
    SHAPE_CENTRE = other("environment.shape.centre", "rad", FINITE), Default(0.0), "0.0";
    /// Where the next detent takes the knob, in pitches from the centre of the present one: a line from there
    /// to the torque, in place of the wave. Greater than 0.5 and at most 10; 1.1 is smooth, 0.55 is like a
    /// switch. One shape may have it; it needs a coupling, and a delay of 0 or 1.
    SHAPE_SNAP = other("environment.shape.snap", "pitches", POSITIVE),
        Optional("a wave of straight lines, which has no snap point"), "1.1";
    /// Lower end.
    SHAPE_FROM = other("environment.shape.from", "rad", FINITE), Needed, "-2.618";
    /// Upper end.
    SHAPE_TO = other("environment.shape.to", "rad", FINITE), Needed, "2.618";
    /// Stiffness of the spring.
    SHAPE_STIFFNESS = other("environment.shape.stiffness", "N m/rad", POSITIVE), Needed, "15.0";
    /// How far the shape reaches to either side.
    SHAPE_WIDTH = other("environment.shape.width", "rad", POSITIVE), Needed, "0.3";
    /// Angle of either place to rest at.
    SHAPE_DISTANCE = other("environment.shape.distance", "rad", POSITIVE), Needed, "0.3";
    /// Distance of two ridges.
    SHAPE_PITCH = other("environment.shape.pitch", "rad", POSITIVE), Needed, "0.05";
    /// Largest torque of the ridges.
    SHAPE_AMPLITUDE = other("environment.shape.amplitude", "N m", POSITIVE), Needed, "0.005";
    /// Angle of the place that pulls.
    SHAPE_ANGLE = other("environment.shape.angle", "rad", FINITE), Default(0.0), "0.5";
    /// Knots, as `environment.knots`.
    SHAPE_KNOTS = other("environment.shape.knots", "", KNOTS_IN_ORDER),
        Needed, "[[0.0, 0.0], [0.1, 0.02], [0.3, -0.02], [0.4, 0.0]]";
    /// Their period, as `environment.period`.
    SHAPE_PERIOD = other("environment.shape.period", "rad", POSITIVE),
        Optional("they do not repeat"), "0.4";

    /// Start of a simulation, and torque of the hand. `run` does not read it.
    SIMULATION = other("simulation", "", TABLE),
        Optional("nothing that `simulate` could start from"), "";
    /// Number of samples.
    SAMPLES = other("simulation.samples", "samples", whole(1, 100_000_000)), Needed, "2000";
    /// Position at sample 0.
    POSITION = other("simulation.position", "rad", FINITE), Default(0.0), "0.001";
    /// Velocity at sample 0.
    VELOCITY = other("simulation.velocity", "rad/s", FINITE), Default(0.0), "0.1";
    /// Torque of the hand, a value a sample, held over it; none after the last. The hand has one of
    /// `torque`, `torque_file`, `torque_sine` and `torque_pulses`.
    TORQUE = other("simulation.torque", "", Bound::Other(Form::Numbers, "a list of finite numbers in N m")),
        Optional("no torque of this kind"), "[0.1, 0.2]";
    /// The same in a file, one number a line; its name is relative to the scene file.
    TORQUE_FILE = other("simulation.torque_file", "", Bound::Other(Form::Text, "the name of a file")),
        Optional("no torque of this kind"), "\"push.csv\"";
    /// A sine torque of the hand.
    TORQUE_SINE = other("simulation.torque_sine", "", TABLE),
        Optional("no torque of this kind"), "{ amplitude = 0.01, omega = 60.0 }";
    /// Amplitude of the sine.
    SINE_AMPLITUDE = other("simulation.torque_sine.amplitude", "N m", FINITE), Needed, "0.01";
    /// Angular frequency of the sine.
    SINE_OMEGA = other("simulation.torque_sine.omega", "rad/s", NOT_NEGATIVE), Needed, "60.0";
    /// Phase of the sine at sample 0.
    SINE_PHASE = other("simulation.torque_sine.phase", "rad", FINITE), Default(0.0), "0.5";
    /// Whether the sine is held over each sample.
    SINE_HELD = other("simulation.torque_sine.held", "", BOOLEAN),
        Optional("false: continuous in time"), "true";
    /// Pulses of the hand's torque.
    TORQUE_PULSES = other("simulation.torque_pulses", "", TABLE),
        Optional("no torque of this kind"), "{ amplitude = 0.1, every = 500, length = 250 }";
    /// Height of the pulses.
    PULSE_AMPLITUDE = other("simulation.torque_pulses.amplitude", "N m", FINITE), Needed, "0.1";
    /// From the start of one pulse to the start of the next.
    PULSE_EVERY = other("simulation.torque_pulses.every", "samples", whole(1, 100_000_000)),
        Needed, "500";
    /// How long a pulse lasts.
    PULSE_LENGTH = other("simulation.torque_pulses.length", "samples", whole(1, 100_000_000)),
        Needed, "250";

    /// Torque that a host wants from the motor, a value a sample; none after the last. Positive in the direction
    /// of the angle. It needs `[host]`, whose budget limits it.
    HOST_TORQUES = other("simulation.host", "", Bound::Other(Form::Numbers, "a list of finite numbers in N m")),
        Optional("the host wants no torque"), "[0.1, 0.2]";
    /// Dry friction in the simulation, where it is not that of the device.
    FRICTION = other("simulation.friction", "N m", NOT_NEGATIVE),
        Optional("`device.friction`, or none"), "0.002";
    /// Time from a sample to its torque that is only simulated, less than the period, in addition to
    /// `servo.output_delay`.
    LATENCY = other("simulation.latency", "s", NOT_NEGATIVE), Default(0.0), "0.0002";
    /// Ticks in which the servo does not run: every so many, or by chance.
    MISSED = other("simulation.missed", "", TABLE),
        Optional("none is missed"), "{ fraction = 0.01, seed = 1 }";
    /// Number of ticks of which the last is missed, or the last `length`.
    MISSED_EVERY = other("simulation.missed.every", "ticks", whole(2, 1_000_000)),
        Optional("`simulation.missed.fraction` decides"), "2";
    /// Number of ticks that are missed in a row, less than `every`.
    MISSED_LENGTH = other("simulation.missed.length", "ticks", whole(1, 1_000_000)), Default(1.0), "1";
    /// Probability that a tick is missed.
    MISSED_FRACTION = other("simulation.missed.fraction", "", FRACTION),
        Optional("`simulation.missed.every` decides"), "0.01";
    /// Seed of the chance: the same seed misses the same ticks.
    MISSED_SEED = other("simulation.missed.seed", "", whole(0, u32::MAX)), Default(0.0), "1";
    /// Readings of the encoder that fail: every so many, or by chance. The reading before takes their place or, with a
    /// `servo.worst_period` that is long enough, the tick is missed; more in a row than `encoder.dropped` end the
    /// simulation with the fault `encoder-reading`.
    FAILED = other("simulation.dropped", "", TABLE),
        Optional("no reading fails"), "{ fraction = 0.01, seed = 1 }";
    /// Number of readings of which the last fails, or the last `length`.
    FAILED_EVERY = other("simulation.dropped.every", "ticks", whole(2, 1_000_000)),
        Optional("`simulation.dropped.fraction` decides"), "7";
    /// Number of readings that fail in a row, less than `every`. As many as `encoder.dropped`, of one more, are the worst
    /// that the certificate allows.
    FAILED_LENGTH = other("simulation.dropped.length", "ticks", whole(1, 1_000_000)), Default(1.0), "1";
    /// Probability that a reading fails.
    FAILED_FRACTION = other("simulation.dropped.fraction", "", FRACTION),
        Optional("`simulation.dropped.every` decides"), "0.01";
    /// Seed of the chance.
    FAILED_SEED = other("simulation.dropped.seed", "", whole(0, u32::MAX)), Default(0.0), "1";

    /// A passive hand that holds the device, for `simulate`, `stability` and `run`.
    HUMAN = other("human", "", TABLE),
        Optional("nobody holds the device; in `run`, the hand of the demonstration"), "";
    /// Inertia of the hand.
    HUMAN_INERTIA = other("human.inertia", "kg m^2", NOT_NEGATIVE), Default(0.0), "1e-4";
    /// Damping of the hand.
    HUMAN_DAMPING = other("human.damping", "N m s/rad", NOT_NEGATIVE), Default(0.0), "0.02";
    /// Stiffness of the hand.
    HUMAN_STIFFNESS = other("human.stiffness", "N m/rad", NOT_NEGATIVE), Default(0.0), "6.0";

    /// Bounds of the hardware.
    LIMITS = other("limits", "", TABLE), Optional("no limits"), "";
    /// Largest torque that the servo gives; it becomes part of the certified scene.
    TORQUE_LIMIT = of(Parameter::TorqueLimit),
        Optional("no limit: the linear loop is certified; a board refuses scenes that pass only so"), "1.0";
    /// Angle of one encoder count.
    ENCODER_STEP = other("limits.encoder_step", "rad", POSITIVE),
        Optional("not known: nothing is said of rest, and `run` takes 65536 counts a turn"), "1e-4";
    /// Counts of the encoder in a turn, in place of the angle of one.
    COUNTS_PER_TURN = other("limits.counts_per_turn", "counts", POSITIVE),
        Optional("`limits.encoder_step` states it"), "4096.0";
    /// Torque of the motor at the largest code of the DAC.
    FULL_SCALE = other("limits.full_scale", "N m", POSITIVE),
        Optional("not known: `run` takes the torque limit, and that of a host, or 5 N m"), "2.0";

    /// A host that adds any torque to the scene's, within a budget: whatever it sends, the hand gets from it at
    /// most the energy at once and the power on average. Programs for boards have it, and `simulate` reads it.
    HOST = other("host", "", TABLE), Optional("no torque but the scene's"), "";
    /// Energy that the hand can get at once.
    HOST_ENERGY = other("host.energy", "J", POSITIVE), Needed, "0.05";
    /// Power that the hand can get on average; with 0 the device comes to rest.
    HOST_POWER = other("host.power", "W", NOT_NEGATIVE), Needed, "0.5";
    /// The part of the device's damping that pays for the host's torque; below the scene's margin.
    HOST_DAMPING = other("host.damping", "N m s/rad", POSITIVE), Needed, "0.001";
    /// Largest torque of the host. With the torque limit it is at most the full scale.
    HOST_TORQUE = other("host.torque", "N m", POSITIVE), Needed, "0.5";
    /// Time after which a torque without a successor has faded to zero.
    HOST_TIMEOUT = other("host.timeout", "s", POSITIVE), Default(0.1), "0.1";

    /// The supply of a bridge that drives the motor. A hand that pushes into a wall and lets go returns energy
    /// to it.
    SUPPLY = other("supply", "", TABLE), Optional("nothing is said of the supply"), "";
    /// Whether the supply takes energy back and keeps its voltage, as a battery or a brake resistor does. If
    /// not, the voltages, the capacitance and a torque limit must be there.
    SINKS = other("supply.sinks", "", BOOLEAN), Optional("false"), "false";
    /// Highest voltage that the supply itself delivers, with its tolerance.
    SUPPLY_VOLTAGE = other("supply.voltage", "V", POSITIVE),
        Optional("an error where the supply does not sink"), "15.0";
    /// Lowest voltage at which the bridge may switch itself off, with the error of its measurement.
    FAULT_VOLTAGE = other("supply.fault_voltage", "V", POSITIVE),
        Optional("an error where the supply does not sink"), "24.6";
    /// Least capacitance at the bridge, with its tolerance.
    CAPACITANCE = other("supply.capacitance", "F", POSITIVE),
        Optional("an error where the supply does not sink"), "0.001";
    /// Largest speed of the device, above which the servo has a fault.
    LARGEST_SPEED = other("supply.largest_speed", "rad/s", POSITIVE), Default(100.0), "25.0";

    /// The motor that a board's own bridge drives, beside `[supply]`; a device file may have this table, too. The
    /// current loop's times are in `device.actuator_lag`, `device.actuator_updates` and `servo.output_delay`.
    MOTOR = other("motor", "", TABLE), Optional("an amplifier outside of the board drives the motor"), "";
    /// Between the terminals of a brushed motor, of one phase of a brushless one.
    RESISTANCE = other("motor.resistance", "ohm", POSITIVE), Needed, "0.6";
    /// The same of its inductance.
    INDUCTANCE = other("motor.inductance", "H", POSITIVE), Needed, "0.00012";
    /// Torque at the handle; of a brushless motor per ampere of a phase current's amplitude.
    TORQUE_CONSTANT = other("motor.torque_constant", "N m/A", POSITIVE), Needed, "0.29";
    /// Electrical turns in a turn of the handle, of a brushless motor.
    POLE_PAIRS = other("motor.pole_pairs", "", whole(1, u16::MAX as u32)), Optional("a brushed motor"), "7";
    /// The phase of a brushless motor at the index of its encoder, as a board tells it after an alignment. A chip's index
    /// is its zero, so that the motor is aligned from the first reading on.
    INDEX_OFFSET = other("motor.index_offset", "", TABLE), Optional("the motor is aligned after each reset"),
        "{ counts = 812, is_reversed = false }";
    /// Electrical angle at the index, less than an electrical turn.
    INDEX_OFFSET_COUNTS = other("motor.index_offset.counts", "counts", whole(0, (1 << 24) - 1)), Needed, "812";
    /// Whether that angle falls while the count rises.
    INDEX_OFFSET_REVERSED = other("motor.index_offset.is_reversed", "", BOOLEAN),
        Optional("false"), "false";
    /// Lowest voltage of the supply, under load.
    LOWEST_SUPPLY = other("motor.lowest_supply", "V", POSITIVE), Needed, "12.0";
    /// Highest voltage, when the motor feeds the supply: above this, over-voltage is a fault.
    HIGHEST_SUPPLY = other("motor.highest_supply", "V", POSITIVE), Needed, "25.2";
}

/// The keys of parts that may be beside every type of environment that is a sum of parts.
pub const BESIDE: &[&Key] = &[&DRAG];

/// Keys that state the number of another key in a unit that data sheets have: the key, the other key, and the
/// product of their values. A file that is written has the other key.
pub const RECIPROCALS: [(&Key, &Key, f64); 2] =
    [(&RATE, &PERIOD, 1.0), (&COUNTS_PER_TURN, &ENCODER_STEP, TAU)];

/// The keys of ticks that are missed, and of readings that fail: every so many, how many of them, by chance, its seed.
pub const OF_MISSED: [&Key; 4] = [&MISSED_EVERY, &MISSED_LENGTH, &MISSED_FRACTION, &MISSED_SEED];
/// See there.
pub const OF_FAILED: [&Key; 4] = [&FAILED_EVERY, &FAILED_LENGTH, &FAILED_FRACTION, &FAILED_SEED];

/// The keys of a device file, which are those of a scene file. Its name is not that of the scene.
pub const OF_DEVICE_FILE: [&Key; 7] =
    [&NAME, &DEVICE, &READING, &ANTICOGGING, &LIMITS, &SUPPLY, &MOTOR];

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
}
