//! Whether the sampled loop of a scene, one device and one hand dies away: its eigenvalues, and
//! the stiffness at which they leave the unit circle.
//!
//! The result is for one device in one hand; the certificate covers every passive hand.
//! One-sidedness, torque limit and quantisation are left out: the loop is that of the scene deep
//! inside its wall.

mod borders;
mod eigenvalues;

use haptic_servo::parameter::Parameter;
use std::fmt;

use nalgebra::{Complex, DMatrix};
use serde::Serialize;

use crate::simulation::closed_loop::ClosedLoop;
use crate::simulation::{Experiment, Integration, SimulationError};

pub use eigenvalues::{eigenvalues, radius};

use borders::Borders;

/// Distance from the unit circle within which an eigenvalue counts as being on it.
pub const ON_CIRCLE: f64 = 1e-10;

/// The behaviour of a small motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StabilityVerdict {
    /// It dies away.
    Stable,
    /// It grows.
    Unstable,
    /// It neither grows nor dies away. Most often this is the device that stays where it is left
    /// because no spring pulls it anywhere, the eigenvalue 1 of its position.
    Marginal,
}

impl fmt::Display for StabilityVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Stable => "stable",
            Self::Unstable => "unstable",
            Self::Marginal => "marginal",
        })
    }
}

/// The answer to "is this loop stable".
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stability {
    /// Largest modulus of the closed loop's eigenvalues: the factor by which motion grows a tick.
    pub spectral_radius: f64,
    /// The verdict that follows from it.
    pub verdict: StabilityVerdict,
    /// Stiffness of the environment in N m/rad at which the loop stops being stable, everything
    /// else as it is: the upper end of the lowest range in which it is. `None` where there is no
    /// such range or it has no end, or where the environment has no stiffness.
    pub critical_stiffness: Option<f64>,
}

/// Judges the loop of an experiment, taken through each tick by `integration`.
///
/// # Errors
/// Where the scene has no closed loop, or its eigenvalues are not found.
pub fn judge(
    experiment: &Experiment,
    integration: Integration,
) -> Result<Stability, SimulationError> {
    let closed = closed_loop(experiment, integration)?;
    let eigenvalues = eigenvalues(&closed.matrix)?;
    Ok(Stability {
        spectral_radius: radius(&eigenvalues),
        verdict: verdict(&closed.matrix, &eigenvalues),
        critical_stiffness: critical_stiffness(experiment, integration)?,
    })
}

/// The loop of an experiment as a matrix.
///
/// # Errors
/// Where the scene has none.
pub fn closed_loop(
    experiment: &Experiment,
    integration: Integration,
) -> Result<ClosedLoop, SimulationError> {
    Ok(ClosedLoop::new(&experiment.tick(integration)?, &experiment.scene)?)
}

fn verdict(matrix: &DMatrix<f64>, eigenvalues: &[Complex<f64>]) -> StabilityVerdict {
    let radius = radius(eigenvalues);
    if radius < 1.0 - ON_CIRCLE {
        return StabilityVerdict::Stable;
    }
    let on_circle = eigenvalues.iter().filter(|z| z.norm() >= 1.0 - ON_CIRCLE);
    let bounded = radius <= 1.0 + ON_CIRCLE
        && on_circle.clone().all(|&z| is_simple(matrix, z, on_circle.clone()));
    if bounded { StabilityVerdict::Marginal } else { StabilityVerdict::Unstable }
}

/// Whether an eigenvalue has as many directions of its own as it has multiplicity; where it has
/// fewer, motion grows although the eigenvalue does not.
fn is_simple<'e>(
    matrix: &DMatrix<f64>,
    eigenvalue: Complex<f64>,
    others: impl Iterator<Item = &'e Complex<f64>>,
) -> bool {
    /// Rounding moves the two eigenvalues of a double one apart by the square root of itself.
    const TOGETHER: f64 = 1e-6;
    let count = others.filter(|&&other| (other - eigenvalue).norm() < TOGETHER).count();
    if count == 1 {
        return true;
    }
    let mut shifted = matrix.map(|entry| Complex::new(entry, 0.0));
    for i in 0..shifted.nrows() {
        shifted[(i, i)] -= eigenvalue;
    }
    let singular = shifted.singular_values();
    let small = TOGETHER * singular.amax();
    singular.iter().filter(|&&value| value <= small).count() >= count
}

/// Stiffness in N m/rad at which the loop stops being stable; see
/// [`Stability::critical_stiffness`].
///
/// An eigenvalue crosses the unit circle at `z` where `1 + E (V + G) = 0` (theory, section 2). The
/// environment is `E = E_0 + K E_1`, so that at every `z` there is one `K` that satisfies this, and
/// the loop crosses where that `K` is real. All such `K` are found first; between two of them the
/// loop is either stable or not.
///
/// # Errors
/// Where the scene has no closed loop, or its eigenvalues are not found.
pub fn critical_stiffness(
    experiment: &Experiment,
    integration: Integration,
) -> Result<Option<f64>, SimulationError> {
    /// Error of the eigenvalues when the slowest of a heavy machine is next to 1.
    const ROUNDING: f64 = 1e-12;
    if experiment.scene.get(Parameter::Stiffness).is_none() {
        return Ok(None);
    }
    let borders = Borders::new(experiment, integration)?.all();
    let is_stable = |stiffness: f64| -> Result<bool, SimulationError> {
        let Some(scene) = experiment.scene.with(Parameter::Stiffness, stiffness) else {
            return Ok(false);
        };
        let changed = Experiment { scene, ..experiment.clone() };
        let closed = closed_loop(&changed, integration)?;
        Ok(radius(&eigenvalues(&closed.matrix)?) <= 1.0 + ROUNDING)
    };
    let mut below = 0.0;
    let mut was_stable = false;
    let beyond = borders.last().map(|last| 3.0 * last);
    for border in borders.iter().copied().chain(beyond) {
        let is_stable = is_stable(0.5 * (below + border))?;
        if was_stable && !is_stable {
            return Ok(Some(below));
        }
        (below, was_stable) = (border, is_stable);
    }
    Ok(None)
}

#[cfg(test)]
mod tests;
