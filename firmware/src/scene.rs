//! A scene in SI units: a device, a period, a coupling, an environment.
//!
//! Nothing is checked here. [`crate::certificate`] turns a [`Scene`] into a `Certified<Scene>`, and only that
//! can become a servo.

use crate::build_error::BuildError;
use crate::environment::{Environment, LawContext};

pub use crate::coupling::Coupling;
pub use crate::encoder_reading::EncoderReading;
pub use crate::latency::{Latency, TimeRange};
use crate::parameter::{NamedParameters, Parameter, numbers};

/// A haptic scene: all data for the certificate and the servo.
///
/// `E` is the environment: one of the types of [`crate::environment`] in a constant of a program, or
/// [`Environment`] for a scene from a file or from the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Scene<E = Environment> {
    /// The device that the hand holds.
    pub device: Device,
    /// The timing of the servo.
    pub timing: Timing,
    /// The coupling between device and environment.
    pub coupling: Coupling,
    /// The environment.
    pub environment: E,
    /// The delays of the torque in addition to the environment's whole samples.
    pub latency: Latency,
    /// Largest coupling torque in N m, applied between environment and coupling so that
    /// saturation stays inside the certificate (theory, end of section 5). `None`: the scene is
    /// linear, and the certificate assumes that the DAC never saturates.
    pub torque_limit: Option<f64>,
}

/// A rigid one-axis device.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Device {
    /// Inertia `m` in kg m^2; used by simulation only, the certificate does not depend on it.
    pub inertia: f64,
    /// Total viscous damping `b` to the ground in N m s/rad; a free-mode canceller cancels it.
    pub damping: f64,
    /// Output strict passivity `delta` in N m s/rad if it differs from the damping: measured, or computed for
    /// a device with internal modes. At most the damping.
    pub passivity: Option<f64>,
}

/// Sampling of the servo.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Timing {
    /// Nominal period `T` in s.
    pub period: f64,
    /// Longest tolerated time in s between two updates of the torque; `None`: the period.
    pub worst_period: Option<f64>,
}

impl Timing {
    /// The longest tolerated time in s between two updates, if it differs from the period: updates may then be
    /// missed.
    pub const fn longer_period(&self) -> Option<f64> {
        match self.worst_period {
            Some(worst) if worst != self.period => Some(worst),
            _ => None,
        }
    }
}

impl Device {
    /// Output strict passivity `delta` in N m s/rad: the damping unless another value is declared.
    pub const fn passivity(&self) -> f64 {
        or!(self.passivity, self.damping)
    }

    /// A device whose passivity is its damping: inertia in kg m^2, damping in N m s/rad.
    pub const fn damped(inertia: f64, damping: f64) -> Self {
        Self { inertia, damping, passivity: None }
    }
}

impl<E> Scene<E> {
    /// An environment on a device at a period in s: coupled rigidly, without latency, missed updates and a
    /// limit.
    pub const fn of(device: Device, period: f64, environment: E) -> Self {
        let timing = Timing { period, worst_period: None };
        let (coupling, latency) = (Coupling::Rigid, Latency::NONE);
        Self { device, timing, coupling, environment, latency, torque_limit: None }
    }

    /// The rest of the scene, for the environment.
    pub const fn context(&self) -> LawContext {
        LawContext {
            period: self.timing.period,
            worst_period: self.timing.worst_period,
            damping: self.device.damping,
            passivity: self.device.passivity(),
            coupling: self.coupling,
            latency: self.latency,
        }
    }

    /// The same scene with another environment.
    pub const fn in_environment<T>(&self, environment: T) -> Scene<T> {
        Scene {
            device: self.device,
            timing: self.timing,
            coupling: self.coupling,
            environment,
            latency: self.latency,
            torque_limit: self.torque_limit,
        }
    }

    /// Inputs of the coefficients.
    pub(crate) fn setting(&self) -> Result<LawContext, BuildError> {
        let (period, coupling) = (self.timing.period, self.coupling);
        BuildError::unless_positive("period", period)?;
        if let Coupling::Spring { stiffness } = coupling {
            BuildError::unless_positive("coupling stiffness", stiffness)?;
        }
        Ok(self.context())
    }
}

impl<E> Scene<E> {
    numbers! {
        own_number, own_number_mut, own_numbers, value;
        Inertia: Self { device: Device { inertia: value, .. }, .. },
        DeviceDamping: Self { device: Device { damping: value, .. }, .. },
        Passivity: Self { device: Device { passivity: Some(value), .. }, .. },
        Period: Self { timing: Timing { period: value, .. }, .. },
        WorstPeriod: Self { timing: Timing { worst_period: Some(value), .. }, .. },
        CouplingStiffness: Self { coupling: Coupling::Spring { stiffness: value }, .. },
        TorqueLimit: Self { torque_limit: Some(value), .. },
        OutputDelay: Self { latency: Latency { output_delay: TimeRange { most: value, .. }, .. }, .. },
        OutputJitter: Self { latency: Latency { output_jitter: value, .. }, .. },
        CountJitter: Self { latency: Latency { count_jitter: value, .. }, .. },
        ActuatorLag: Self { latency: Latency { actuator_lag: TimeRange { most: value, .. }, .. }, .. },
        SensorLag: Self { latency: Latency { sensor_lag: TimeRange { most: value, .. }, .. }, .. },
        ActuatorResponse: Self { latency: Latency { actuator_response: TimeRange { most: value, .. }, .. }, .. },
    }
}

/// The tunable parameters, and the environment's own.
impl<E: NamedParameters> NamedParameters for Scene<E> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match parameter {
            Parameter::CouplingStiffness | Parameter::TorqueLimit => self.own_number_mut(parameter),
            _ => self.environment.value(parameter),
        }
    }
}

impl Scene {
    /// The value of a parameter; `None` if the scene does not have it, and for polynomials. For the range of
    /// a time it is the longest time.
    ///
    /// ```
    /// use haptic_servo::certificate::Parameter;
    /// # use haptic_servo::environment::Canceller;
    /// # use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
    /// # let scene = Scene {
    /// #     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    /// #     timing: Timing { period: 1e-3, worst_period: None },
    /// #     coupling: Coupling::Spring { stiffness: 44.0 },
    /// #     environment: Canceller { residual: 0.01, delay: 1 }.alone(),
    /// #     latency: Latency::NONE, torque_limit: None,
    /// # };
    /// assert_eq!(scene.get(Parameter::Residual), Some(0.01));
    /// assert_eq!(scene.get(Parameter::Stiffness), None);
    /// let softer = scene.with(Parameter::CouplingStiffness, 40.0).unwrap();
    /// assert_eq!(softer.coupling, Coupling::Spring { stiffness: 40.0 });
    /// ```
    pub const fn get(&self, parameter: Parameter) -> Option<f64> {
        match self.own_number(parameter) {
            Some(value) => Some(*value),
            None => self.environment.get(parameter),
        }
    }

    /// The largest sum in s of output jitter and count jitter that it may have.
    pub const fn largest_jitter(&self) -> f64 {
        self.latency.largest_jitter(self.environment.is_late(), self.timing.period)
    }

    /// The scene with this value, including optional parameters that it did not have: a passivity, a worst
    /// period, a coupling, a torque limit. `None` if the scene cannot have it.
    pub const fn with(&self, parameter: Parameter, value: f64) -> Option<Self> {
        let mut changed = *self;
        match parameter {
            Parameter::Passivity => changed.device.passivity = Some(value),
            Parameter::WorstPeriod => changed.timing.worst_period = Some(value),
            Parameter::CouplingStiffness => {
                changed.coupling = Coupling::Spring { stiffness: value }
            }
            Parameter::TorqueLimit => changed.torque_limit = Some(value),
            Parameter::OutputDelay => changed.latency.output_delay = TimeRange::exactly(value),
            Parameter::ActuatorLag => changed.latency.actuator_lag = TimeRange::exactly(value),
            Parameter::SensorLag => changed.latency.sensor_lag = TimeRange::exactly(value),
            Parameter::ActuatorResponse => {
                changed.latency.actuator_response = TimeRange::exactly(value);
            }
            _ => match changed.own_number_mut(parameter) {
                Some(place) => *place = value,
                None => match changed.environment.with(parameter, value) {
                    Some(environment) => changed.environment = environment,
                    None => return None,
                },
            },
        }
        Some(changed)
    }
}
