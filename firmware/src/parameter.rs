//! The parameters of a scene: one table of their keys, names, units and ranges, and the traits that read and
//! set them.
//!
//! A new parameter is added here, in its environment ([`NamedParameters`]), and, for scene files, as a row of
//! their reference.

/// Largest degree of a rational environment's numerator or denominator.
pub const MAX_DEGREE: usize = 8;

/// Longest delay in samples.
pub const MAX_DELAY: usize = 8;

/// The values of a parameter that are valid in some scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// Finite and greater than zero.
    Positive,
    /// Finite and not below zero.
    NotNegative,
    /// At least zero and less than one.
    Fraction,
    /// From zero to one.
    Share,
    /// A whole number from the first to the second, both included.
    Whole(u32, u32),
}

impl Range {
    /// Whether `value` is in the range; every value in a range is finite.
    ///
    /// The bits of doubles of one sign have the order of their values, and a small board compares integers in
    /// a tenth of the time.
    pub const fn admits(self, value: f64) -> bool {
        const INFINITE: u64 = f64::INFINITY.to_bits();
        const MINUS_ZERO: u64 = (-0.0_f64).to_bits();
        let bits = value.to_bits();
        match self {
            Self::Finite => bits & !MINUS_ZERO < INFINITE,
            Self::Positive => bits != 0 && bits < INFINITE,
            Self::NotNegative => bits < INFINITE || bits == MINUS_ZERO,
            Self::Fraction => bits < 1.0_f64.to_bits() || bits == MINUS_ZERO,
            Self::Share => bits <= 1.0_f64.to_bits() || bits == MINUS_ZERO,
            Self::Whole(least, most) => {
                value as u32 as f64 == value && value as u32 >= least && value as u32 <= most
            }
        }
    }
}

macro_rules! parameters {
    ($($parameter:ident: $key:literal, $name:literal, $unit:literal, $range:expr;)*) => {
        /// A parameter of a scene. The order is that of the wire.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
        pub enum Parameter {
            $(#[doc = concat!("`", $key, "`: the ", $name)] $parameter,)*
        }

        impl Parameter {
            /// All parameters, in the order in which a scene is checked.
            pub const ALL: &[Self] = &[$(Self::$parameter),*];

            /// Full name in a scene file, such as `device.inertia`.
            pub const fn key(self) -> &'static str {
                match self {
                    $(Self::$parameter => $key,)*
                }
            }

            /// Name and unit for messages; the unit of a pure number is empty.
            pub const fn name_and_unit(self) -> (&'static str, &'static str) {
                match self {
                    $(Self::$parameter => ($name, $unit),)*
                }
            }

            /// The valid values; for polynomials, those of each coefficient.
            pub const fn range(self) -> Range {
                match self {
                    $(Self::$parameter => $range,)*
                }
            }
        }
    };
}

parameters! {
    Inertia: "device.inertia", "device inertia", "kg m^2", Range::Positive;
    DeviceDamping: "device.damping", "device damping", "N m s/rad", Range::NotNegative;
    Passivity: "device.passivity", "device passivity", "N m s/rad", Range::Finite;
    Period: "servo.period", "period", "s", Range::Positive;
    WorstPeriod: "servo.worst_period", "worst period", "s", Range::Finite;
    CouplingStiffness: "coupling.stiffness", "coupling stiffness", "N m/rad", Range::Positive;
    Stiffness: "environment.stiffness", "stiffness", "N m/rad", Range::Finite;
    Damping: "environment.damping", "damping", "N m s/rad", Range::Finite;
    Filter: "environment.filter", "filter", "", Range::Fraction;
    Delay: "environment.delay", "delay", "samples", Range::Whole(0, MAX_DELAY as u32);
    Face: "environment.face", "face", "rad", Range::Finite;
    Residual: "environment.residual", "residual", "N m s/rad", Range::Finite;
    Numerator: "environment.numerator", "numerator coefficient", "", Range::Finite;
    Denominator: "environment.denominator", "denominator coefficient", "", Range::Finite;
    UnitZeros: "environment.unit_zeros", "number of zeros at 1", "", Range::Whole(0, MAX_DEGREE as u32);
    TorqueLimit: "limits.torque", "torque limit", "N m", Range::Positive;
    StatedIndex: "environment.index", "stated index", "N m s/rad", Range::NotNegative;
    StatedGain: "environment.gain", "stated gain", "N m s/rad", Range::NotNegative;
    OutputDelay: "servo.output_delay", "output delay", "s", Range::NotNegative;
    OutputJitter: "servo.output_jitter", "output jitter", "s", Range::NotNegative;
    ActuatorLag: "device.actuator_lag", "actuator lag", "s", Range::NotNegative;
    SensorLag: "device.sensor_lag", "sensor lag", "s", Range::NotNegative;
    ActuatorResponse: "device.actuator_response", "actuator response", "s", Range::NotNegative;
    ProfileTorque: "environment.torque", "profile torque", "N m", Range::Positive;
    Count: "environment.count", "number of repetitions in a turn", "", Range::Positive;
    Centre: "environment.centre", "profile centre", "rad", Range::Finite;
    From: "environment.from", "lower end stop", "rad", Range::Finite;
    To: "environment.to", "upper end stop", "rad", Range::Finite;
    Mode: "environment.mode", "mode", "", Range::Finite;
    CountJitter: "servo.count_jitter", "count jitter", "s", Range::NotNegative;
    Age: "encoder.age", "age of a reading", "s", Range::NotNegative;
    Window: "encoder.window", "window of the encoder", "s", Range::NotNegative;
    Linearity: "encoder.linearity", "linearity of the encoder", "", Range::Fraction;
    Noise: "encoder.noise", "noise of the encoder", "counts", Range::NotNegative;
    Hysteresis: "encoder.hysteresis", "hysteresis of the encoder", "counts", Range::NotNegative;
    Dropped: "encoder.dropped", "number of readings that may be dropped", "", Range::Whole(0, MAX_DELAY as u32);
    Drag: "environment.drag", "drag", "N m s/rad", Range::Finite;
    Anticogging: "anticogging.share", "anticogging", "", Range::Share;
}

/// The parameters that may be changed while the servo runs, with their names for users.
///
/// No message can change the device; period and delay are fixed at compile time and by the board's set-up.
pub const TUNABLE: [(&str, Parameter); 13] = [
    ("stiffness", Parameter::Stiffness),
    ("damping", Parameter::Damping),
    ("filter", Parameter::Filter),
    ("face", Parameter::Face),
    ("residual", Parameter::Residual),
    ("coupling.stiffness", Parameter::CouplingStiffness),
    ("torque_limit", Parameter::TorqueLimit),
    ("torque", Parameter::ProfileTorque),
    ("count", Parameter::Count),
    ("centre", Parameter::Centre),
    ("mode", Parameter::Mode),
    ("drag", Parameter::Drag),
    ("anticogging", Parameter::Anticogging),
];

/// A type with named parameters.
pub trait NamedParameters {
    /// The value of this parameter; `None` if there is none.
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64>;
}

/// The parameters of a type from one table: functions to read one, to change one, and to list all. A pattern
/// binds the value.
macro_rules! numbers {
    ($number:ident, $number_mut:ident, $numbers:ident, $value:ident;
     $($parameter:ident: $pattern:pat,)*) => {
        /// The value of this parameter; `None` if there is none.
        const fn $number(
            &self,
            parameter: $crate::parameter::Parameter,
        ) -> Option<&f64> {
            match (parameter, self) {
                $(($crate::parameter::Parameter::$parameter, $pattern) => Some($value),)*
                _ => None,
            }
        }

        /// The same, mutable.
        const fn $number_mut(
            &mut self,
            parameter: $crate::parameter::Parameter,
        ) -> Option<&mut f64> {
            match (parameter, self) {
                $(($crate::parameter::Parameter::$parameter, $pattern) => Some($value),)*
                _ => None,
            }
        }

        /// All parameters; a check of all of them costs less in this way than by name.
        pub(crate) const fn $numbers(
            &self,
        ) -> [($crate::parameter::Parameter, Option<f64>);
            [$($crate::parameter::Parameter::$parameter),*].len()] {
            [$((
                $crate::parameter::Parameter::$parameter,
                match self {
                    $pattern => Some(*$value),
                    #[allow(unreachable_patterns)]
                    _ => None,
                },
            )),*]
        }
    };
}
pub(crate) use numbers;
