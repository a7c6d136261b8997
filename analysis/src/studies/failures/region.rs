//! The largest stiffness of a spring that a method shows as stable, over its steps per tick.

use super::setting::*;
use crate::simulation::method::Method;
use crate::simulation::{Experiment, Integration};
use crate::stability::critical_stiffness;
use crate::studies::tradeoff::simulation;

/// The compared methods, the least accurate first.
pub const METHODS: [Method; 4] = [Method::SemiImplicit, Method::Rk4, Method::Tustin, Method::Euler];

/// The steps per tick, about evenly spaced on a logarithmic axis.
const SUBSTEPS: [u32; 21] =
    [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 17, 20, 25, 30, 36, 44, 54, 66, 81, 100];

/// The limits of a spring on one device by several methods.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The device.
    pub device: &'static str,
    /// Stiffness in N m/rad above which the loop is unstable.
    pub truth: f64,
    /// Largest certified stiffness in N m/rad.
    pub certified: f64,
    /// The apparent limit by each of [`METHODS`]: steps per tick and stiffness in N m/rad, zero if no spring
    /// appears stable.
    pub apparent: [Vec<(f64, f64)>; METHODS.len()],
}

impl Region {
    /// An undelayed spring without a coupling on the heavy knob, and on two masses in a hand.
    pub fn all() -> Result<[Self; 2], StudyError> {
        let [knob, held] = simulation::cases();
        Ok([Self::of(knob.name, &knob.experiment)?, Self::of(held.name, &held.experiment)?])
    }

    fn of(device: &'static str, experiment: &Experiment) -> Result<Self, StudyError> {
        let limit = |method, substeps| -> Result<f64, StudyError> {
            let integration = Integration { method, substeps };
            Ok(critical_stiffness(experiment, integration)?.unwrap_or(0.0))
        };
        let certified = limit_of(&experiment.scene)?;
        let mut apparent = [const { Vec::new() }; METHODS.len()];
        for (method, points) in METHODS.into_iter().zip(&mut apparent) {
            for substeps in SUBSTEPS {
                points.push((f64::from(substeps), limit(method, substeps)?));
            }
        }
        Ok(Self { device, truth: limit(Method::Exact, 1)?, certified, apparent })
    }
}
