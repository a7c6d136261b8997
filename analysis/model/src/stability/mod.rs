//! Whether the sampled loop of a scene, one device and one hand dies away: its eigenvalues, and
//! the stiffness at which they leave the unit circle.
//!
//! The result is for one device in one hand; the certificate covers every passive hand.
//! One-sidedness, torque limit and quantisation are left out: the loop is that of the scene deep
//! inside its wall.

mod ball;
mod borders;
mod characteristic;
mod eigenvalues;

use haptic_servo::parameter::Parameter;
use std::fmt;

use nalgebra::{Complex, DMatrix};
use serde::Serialize;

use crate::nominal_latency::left_out_of_loop;
use crate::simulation::closed_loop::ClosedLoop;
use crate::simulation::{Experiment, Integration, SimulationError};

pub use eigenvalues::{eigenvalues, radius};

pub use characteristic::Characteristic;

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
    /// Rounding hides whether it dies away.
    Undecided,
}

impl fmt::Display for StabilityVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{self:?}").to_lowercase())
    }
}

/// The answer to "is this loop stable".
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stability {
    /// Largest modulus of the closed loop's eigenvalues: the factor by which motion grows a tick. The middle
    /// of its enclosure.
    pub spectral_radius: f64,
    /// Numbers between which the spectral radius is for certain.
    pub spectral_radius_enclosure: [f64; 2],
    /// The verdict that follows from it.
    pub verdict: StabilityVerdict,
    /// Stiffness of the environment in N m/rad at which the loop stops being stable, everything
    /// else as it is: the upper end of the lowest range in which it is. `None` where there is no
    /// such range or it has no end, or where the environment has no stiffness.
    pub critical_stiffness: Option<f64>,
    /// The ends in N m/rad of that range. The first is `None` where the loop is stable down to a stiffness of
    /// 0, and the second is the critical stiffness. `None` where there is no such range.
    pub stable_stiffness: Option<[Option<f64>; 2]>,
    /// The part of the scene that is not in this loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<&'static str>,
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
    let enclosure = Characteristic::of(experiment, integration)?.radius();
    let stable_stiffness = stable_stiffness(experiment, integration)?;
    Ok(Stability {
        spectral_radius: 0.5 * (enclosure[0] + enclosure[1]),
        spectral_radius_enclosure: enclosure,
        verdict: verdict(enclosure, &closed.matrix, &eigenvalues),
        critical_stiffness: stable_stiffness.and_then(|[_, end]| end),
        stable_stiffness,
        left_out: left_out_of_loop(&experiment.scene),
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

fn verdict(
    [low, high]: [f64; 2],
    matrix: &DMatrix<f64>,
    eigenvalues: &[Complex<f64>],
) -> StabilityVerdict {
    // The enclosure is certain; a position that nothing holds, in a matrix of doubles, may be a last bit below.
    if high < 1.0 - 4.0 * f64::EPSILON {
        return StabilityVerdict::Stable;
    }
    if low > 1.0 + ON_CIRCLE {
        return StabilityVerdict::Unstable;
    }
    let found = radius(eigenvalues);
    if high - low > ON_CIRCLE || (found - 1.0).abs() > 2.0 * ON_CIRCLE {
        return StabilityVerdict::Undecided;
    }
    let on_circle = eigenvalues.iter().filter(|z| z.norm() >= 1.0 - 2.0 * ON_CIRCLE);
    let bounded = on_circle.clone().all(|&z| is_simple(matrix, z, on_circle.clone()));
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
/// # Errors
/// Those of [`stable_stiffness`].
pub fn critical_stiffness(
    experiment: &Experiment,
    integration: Integration,
) -> Result<Option<f64>, SimulationError> {
    Ok(stable_stiffness(experiment, integration)?.and_then(|[_, end]| end))
}

/// The lowest range of stiffnesses in N m/rad in which the loop is stable; see
/// [`Stability::stable_stiffness`].
///
/// An eigenvalue crosses the unit circle at `z` where `1 + E (V + G) = 0` (theory, section 2). The
/// environment is `E = E_0 + K E_1`, so that at every `z` there is one `K` that satisfies this, and
/// the loop crosses where that `K` is real. All such `K` are found first; between two of them the
/// loop is either stable or not.
///
/// # Errors
/// Where the scene has no closed loop.
pub fn stable_stiffness(
    experiment: &Experiment,
    integration: Integration,
) -> Result<Option<[Option<f64>; 2]>, SimulationError> {
    /// Growth that a position which nothing holds has by rounding of the scene's numbers.
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
        Ok(Characteristic::of(&changed, integration)?.is_within(1.0 + ROUNDING) == Some(true))
    };
    let mut below = None;
    let mut start = None;
    // Without a border there is one range, in which any stiffness stands for all.
    let beyond = borders.last().map_or(1.0, |last| 3.0 * last);
    for border in borders.iter().copied().chain([beyond]) {
        let is_stable = is_stable(0.5 * (below.unwrap_or(0.0) + border))?;
        match start {
            None if is_stable => start = Some(below),
            Some(start) if !is_stable => return Ok(Some([start, below])),
            _ => {}
        }
        below = Some(border);
    }
    Ok(start.map(|start| [start, None]))
}

#[cfg(test)]
mod tests;
