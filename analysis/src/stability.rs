//! Whether the sampled loop of a scene, one device and one hand dies away: its eigenvalues, and
//! the stiffness at which they leave the unit circle.
//!
//! This is a question about one device in one hand; what no hand can upset is for the certificate
//! to say. One-sidedness, torque limit and converters are left out: the loop is that of the scene
//! deep inside its wall.

use std::f64::consts::PI;

use firmware::environment::Environment;
use firmware::scene::{Coupling, Scene};
use nalgebra::linalg::{Schur, balancing};
use nalgebra::{Complex, DMatrix};
use serde::Serialize;

use crate::response::Response;
use crate::simulation::closed::{ClosedLoop, transfers};
use crate::simulation::plant::POSITION;
use crate::simulation::tick::Tick;
use crate::simulation::{Experiment, SimulationError, Stride};

/// Distance from the unit circle within which an eigenvalue counts as being on it.
pub const ON_CIRCLE: f64 = 1e-10;

/// What becomes of a small motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It dies away.
    Stable,
    /// It grows.
    Unstable,
    /// It neither grows nor dies away. Most often this is the device that stays where it is left
    /// because no spring pulls it anywhere, the eigenvalue 1 of its position.
    Marginal,
}

/// The answer to "is this loop stable".
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stability {
    /// Largest modulus of the closed loop's eigenvalues: the factor by which motion grows a tick.
    pub spectral_radius: f64,
    /// What that means.
    pub verdict: Verdict,
    /// Stiffness of the environment in N m/rad at which the loop stops being stable, everything
    /// else as it is: the upper end of the lowest range in which it is. `None` where there is no
    /// such range or it has no end, or where the environment has no stiffness.
    pub critical_stiffness: Option<f64>,
}

/// Judges the loop of an experiment, taken through each tick by `stride`.
///
/// # Errors
/// Where the scene has no closed loop, or its eigenvalues are not found.
pub fn judge(experiment: &Experiment, stride: Stride) -> Result<Stability, SimulationError> {
    let closed = closed_loop(experiment, stride)?;
    let eigenvalues = eigenvalues(&closed.matrix)?;
    Ok(Stability {
        spectral_radius: radius(&eigenvalues),
        verdict: verdict(&closed.matrix, &eigenvalues),
        critical_stiffness: critical_stiffness(experiment, stride)?,
    })
}

/// The loop of an experiment as a matrix.
///
/// # Errors
/// Where the scene has none.
pub fn closed_loop(experiment: &Experiment, stride: Stride) -> Result<ClosedLoop, SimulationError> {
    let tick = Tick::new(&experiment.plant, &experiment.stepping(stride), 0.0);
    Ok(ClosedLoop::new(&tick, &experiment.scene)?)
}

/// Eigenvalues of a matrix.
///
/// # Errors
/// Where they are not found.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Result<Vec<Complex<f64>>, SimulationError> {
    /// More than the iteration has ever been seen to take, and bounded.
    const ITERATIONS: usize = 10_000;
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return Err(SimulationError::Eigenvalues);
    }
    let mut balanced = matrix.clone();
    balancing::balance_parlett_reinsch(&mut balanced);
    let schur = Schur::try_new(balanced, f64::EPSILON, ITERATIONS);
    let schur = schur.ok_or(SimulationError::Eigenvalues)?;
    Ok(schur.complex_eigenvalues().iter().copied().collect())
}

/// Largest modulus.
pub fn radius(eigenvalues: &[Complex<f64>]) -> f64 {
    eigenvalues.iter().map(|eigenvalue| eigenvalue.norm()).fold(0.0, f64::max)
}

fn verdict(matrix: &DMatrix<f64>, eigenvalues: &[Complex<f64>]) -> Verdict {
    let radius = radius(eigenvalues);
    if radius < 1.0 - ON_CIRCLE {
        return Verdict::Stable;
    }
    let on_circle = eigenvalues.iter().filter(|z| z.norm() >= 1.0 - ON_CIRCLE);
    let bounded = radius <= 1.0 + ON_CIRCLE
        && on_circle.clone().all(|&z| is_simple(matrix, z, on_circle.clone()));
    if bounded { Verdict::Marginal } else { Verdict::Unstable }
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

/// The same scene with another stiffness of its environment; `None` where that has none.
pub fn with_stiffness(scene: &Scene, stiffness: f64) -> Option<Scene> {
    let mut scene = *scene;
    match &mut scene.environment {
        Environment::DelayedSpring(wall)
        | Environment::DamperWall(wall)
        | Environment::FreeModeWall { wall, .. } => wall.stiffness = stiffness,
        Environment::FreeMode { .. } | Environment::Rational(_) => return None,
    }
    Some(scene)
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
    stride: Stride,
) -> Result<Option<f64>, SimulationError> {
    if with_stiffness(&experiment.scene, 0.0).is_none() {
        return Ok(None);
    }
    let borders = Borders::new(experiment, stride)?.all();
    let is_stable = |stiffness: f64| -> Result<bool, SimulationError> {
        let Some(scene) = with_stiffness(&experiment.scene, stiffness) else { return Ok(false) };
        let changed = Experiment { scene, ..experiment.clone() };
        let closed = closed_loop(&changed, stride)?;
        Ok(radius(&eigenvalues(&closed.matrix)?) <= 1.0)
    };
    let mut below = 0.0;
    for border in borders {
        if is_stable(0.5 * (below + border))? && !is_stable(border * (1.0 + 1e-6))? {
            return Ok(Some(border));
        }
        below = border;
    }
    Ok(None)
}

/// The stiffnesses at which some eigenvalue is on the unit circle.
struct Borders {
    tick: Tick,
    compliance: f64,
    /// The environment without stiffness, and with `unit`.
    environments: [Response; 2],
    unit: f64,
}

impl Borders {
    fn new(experiment: &Experiment, stride: Stride) -> Result<Self, SimulationError> {
        let scene = &experiment.scene;
        let device = scene.device;
        let period = scene.timing.period;
        // So stiff that what does not depend on the stiffness has no digits left in the sum.
        let unit = 1e6 * (device.damping / period + device.inertia / (period * period));
        let environment = |stiffness: f64| -> Result<Response, SimulationError> {
            let changed = with_stiffness(scene, stiffness).unwrap_or(*scene);
            Ok(Response::new(transfers(&changed)?.environment))
        };
        Ok(Self {
            tick: Tick::new(&experiment.plant, &experiment.stepping(stride), 0.0),
            compliance: match scene.coupling {
                Coupling::Rigid => 0.0,
                Coupling::Spring { stiffness } => 1.0 / stiffness,
            },
            environments: [environment(0.0)?, environment(unit)?],
            unit,
        })
    }

    /// From the motor's torque to the sampled position, at `z`.
    fn plant(&self, z: Complex<f64>) -> Option<Complex<f64>> {
        let complex = |entry: f64| Complex::new(entry, 0.0);
        let mut shifted = self.tick.transition.map(|entry| complex(-entry));
        for i in 0..shifted.nrows() {
            shifted[(i, i)] += z;
        }
        let effect = self.tick.motor.map(complex) + self.tick.previous.map(complex) / z;
        Some(shifted.lu().solve(&effect)?[POSITION])
    }

    /// The stiffness, complex in general, with which the loop has an eigenvalue at this angle.
    fn at(&self, theta: f64) -> Complex<f64> {
        let z = Complex::from_polar(1.0, theta);
        let one = Complex::new(1.0, 0.0);
        let [without, with] = &self.environments;
        let (without, with) = (without.at(z), with.at(z));
        let each = (with - without) / self.unit;
        // On a pole of the plant the loop is what the environment alone makes of it.
        let through = self.plant(z).map(|plant| one / (plant + self.compliance));
        -(through.unwrap_or_default() + without) / each
    }

    /// All of them that are positive, rising.
    fn all(&self) -> Vec<f64> {
        let angles = self.angles();
        let values: Vec<f64> = angles.iter().map(|&theta| self.at(theta).im).collect();
        let mut found = vec![self.at(PI)];
        for (angle, value) in angles.windows(2).zip(values.windows(2)) {
            if value[0].signum() != value[1].signum() {
                found.push(self.at(self.root(angle[0], angle[1])));
            }
        }
        // Where the sign changed by way of a pole there is no root.
        let real = |k: &Complex<f64>| k.re > 0.0 && k.re.is_finite() && k.im.abs() <= 1e-6 * k.re;
        let mut stiffnesses: Vec<f64> = found.iter().filter(|k| real(k)).map(|k| k.re).collect();
        stiffnesses.sort_by(f64::total_cmp);
        stiffnesses.dedup_by(|a, b| (*a - *b).abs() <= 1e-12 * *b);
        stiffnesses
    }

    /// Angles close enough together that no two roots lie between neighbours: evenly, towards
    /// zero by ratio, and around every resonance of the plant by its width.
    fn angles(&self) -> Vec<f64> {
        const EVEN: u32 = 4096;
        const RATIO: u32 = 512;
        const AROUND: i32 = 24;
        let even = (1..EVEN).map(|i| PI * f64::from(i) / f64::from(EVEN));
        let small = (1..RATIO).map(|i| 1e-3 * 1e-6_f64.powf(f64::from(i) / f64::from(RATIO)));
        let resonances = eigenvalues(&self.tick.transition).unwrap_or_default();
        let around = resonances.iter().flat_map(|pole| {
            let (centre, width) = (pole.arg().abs(), (1.0 - pole.norm()).abs().max(1e-12));
            (-AROUND..=AROUND).map(move |i| {
                let away = width * (1.6_f64.powi(i.abs()) - 1.0);
                centre + away * f64::from(i.signum())
            })
        });
        let mut angles: Vec<f64> = even.chain(small).chain(around).collect();
        // The angle pi is a root by symmetry, and is looked at by itself.
        angles.retain(|theta| (1e-9..PI - 1e-9).contains(theta));
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    }

    /// Where the imaginary part changes its sign.
    fn root(&self, mut low: f64, mut high: f64) -> f64 {
        let sign = self.at(low).im.signum();
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.at(middle).im.signum() == sign { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests;
