//! What a person asks for, in plain SI numbers: a device, a period, a coupling, an environment.
//!
//! Nothing here is checked. [`crate::certificate`] turns a [`Scene`] into a `Certified<Scene>`,
//! and only that can become a servo.

use crate::build_error::BuildError;
use crate::environment::{Environment, Setting};

pub use crate::coupling::Coupling;

/// A haptic scene: everything the certificate and the servo need to know.
///
/// `E` is the environment: one of the types of [`crate::environment`] where the scene is a
/// constant of a program, or [`Environment`] where it comes from a file or over the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Scene<E = Environment> {
    /// The machine that the hand holds.
    pub device: Device,
    /// When the servo runs.
    pub timing: Timing,
    /// What connects the device to the environment.
    pub coupling: Coupling,
    /// What the hand shall feel.
    pub environment: E,
    /// Largest coupling torque in N m, applied between environment and coupling so that
    /// saturation stays inside the certificate (theory, end of section 5). `None`: the scene is
    /// linear, and the certificate assumes that the converter never saturates.
    pub torque_limit: Option<f64>,
}

/// A rigid one-axis device.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Device {
    /// Inertia `m` in kg m^2; used by simulation only, the certificate does not depend on it.
    pub inertia: f64,
    /// Viscous damping `b` to the ground in N m s/rad, all of it; what a free-mode canceller takes away.
    pub damping: f64,
    /// Output strict passivity `delta` in N m s/rad where it is not the damping: measured, or
    /// computed for a device with internal modes. At most the damping.
    pub passivity: Option<f64>,
}

/// Sampling of the servo.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Timing {
    /// Nominal period `T` in s.
    pub period: f64,
    /// Longest time in s between two force updates that is tolerated; `None`: the period.
    pub worst_period: Option<f64>,
}

impl<E> Scene<E> {
    /// What the environment's coefficients depend on.
    pub(crate) fn setting(&self) -> Result<Setting, BuildError> {
        let (period, coupling) = (self.timing.period, self.coupling);
        BuildError::unless_positive("period", period)?;
        if let Coupling::Spring { stiffness } = coupling {
            BuildError::unless_positive("coupling stiffness", stiffness)?;
        }
        Ok(Setting { period, damping: self.device.damping, coupling })
    }
}
