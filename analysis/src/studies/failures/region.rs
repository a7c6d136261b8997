//! Up to which stiffness a method calls a spring stable, over the steps that it takes in a tick.

use super::case::FailureError;
use crate::limits::{Limit, largest_stiffness};
use crate::simulation::method::Method;
use crate::simulation::{Experiment, Integration};
use crate::stability::critical_stiffness;
use crate::studies::tradeoff::simulation;

/// The compared methods, the least accurate one first.
pub const METHODS: [Method; 4] = [Method::SemiImplicit, Method::Rk4, Method::Tustin, Method::Euler];

/// Steps a tick that are looked at, about evenly apart on a logarithmic axis.
const SUBSTEPS: [u32; 21] =
    [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 17, 20, 25, 30, 36, 44, 54, 66, 81, 100];

/// What methods make of a spring on one device.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The device.
    pub device: &'static str,
    /// Stiffness in N m/rad at which the loop stops being stable.
    pub truth: f64,
    /// Largest certified stiffness in N m/rad.
    pub certified: f64,
    /// What each of [`METHODS`] takes for the truth: steps a tick and stiffness in N m/rad, zero
    /// where it calls no spring stable.
    pub apparent: [Vec<(f64, f64)>; METHODS.len()],
}

impl Region {
    /// An undelayed spring without a coupling on the heavy knob, and on two masses in a hand.
    ///
    /// # Errors
    /// Where an eigenvalue is not found.
    pub fn all() -> Result<[Self; 2], FailureError> {
        let [knob, held] = simulation::cases();
        Ok([Self::of(knob.name, &knob.experiment)?, Self::of(held.name, &held.experiment)?])
    }

    fn of(device: &'static str, experiment: &Experiment) -> Result<Self, FailureError> {
        let limit = |method, substeps| -> Result<f64, FailureError> {
            let integration = Integration { method, substeps };
            Ok(critical_stiffness(experiment, integration)?.unwrap_or(0.0))
        };
        let Limit::RoundUp3(certified) = largest_stiffness(&experiment.scene) else {
            return Err(FailureError::NoLimit);
        };
        let mut apparent = [const { Vec::new() }; METHODS.len()];
        for (method, points) in METHODS.into_iter().zip(&mut apparent) {
            for substeps in SUBSTEPS {
                points.push((f64::from(substeps), limit(method, substeps)?));
            }
        }
        Ok(Self { device, truth: limit(Method::Exact, 1)?, certified, apparent })
    }
}
