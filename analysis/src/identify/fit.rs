//! What the responses say: the disk they lie in, and the rigid device that they would be of.

use nalgebra::{Complex, Matrix3, Vector3};
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::error::IdentifyError;
use super::response::{Response, images};
use super::step::LeftOut;
use crate::quantity::significant;

/// Passes between the fit and the images: each gains the square of what the images do.
const IMAGE_PASSES: usize = 3;

/// Confidence of all intervals.
pub const CONFIDENCE: f64 = 0.95;

/// Least motion in counts: below that the encoder's steps are no noise any more.
const LEAST_COUNTS: f64 = 1.5;

/// Largest squared residual, in squared deviations a degree of freedom, of a device that passes for
/// rigid: residuals up to three times of what the noise explains, which allows for noise that is
/// not white.
const RIGID: f64 = 9.0;

/// Smallest relative deviation that is believed: a simulation without noise has none.
const FLOOR: f64 = 1e-9;

/// Gauss-Newton steps; the skew is small, and the rest linear, so that three are enough.
const ITERATIONS: usize = 20;

/// A number with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Estimate {
    /// Whether the interval leaves out 0.
    pub fn is_significant(&self) -> bool {
        self.lo > 0.0 || self.hi < 0.0
    }
}

/// The disk around all responses as they were measured: centre and radius `1/(2 delta)`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Disk {
    /// `min Re(1/J)` in N m s/rad; the responses lie in a disk only if it is positive.
    pub delta: f64,
    /// Lower end of its confidence interval.
    pub lo: f64,
    /// Angular frequency in rad/s of the response that is on the rim.
    pub omega: f64,
}

/// The device found in a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// Inertia in kg m^2.
    pub inertia: Estimate,
    /// Damping in N m s/rad.
    pub damping: Estimate,
    /// Time in s by which the counts are late against the torque, beyond what was declared.
    pub skew: Estimate,
    /// The disk, with the skew in it.
    pub disk: Disk,
    /// Part of `disk.delta` that is the skew's: `b cos(w t0) - m w sin(w t0) - b`, in N m s/rad at
    /// the disk's frequency.
    pub bias: f64,
    /// Mean squared residual of the fit in squared deviations.
    pub misfit: f64,
    /// The responses, in the order of the record.
    pub responses: Vec<Response>,
    /// Tones of the record that none of this is of, and why.
    pub left_out: Vec<LeftOut>,
}

impl Identification {
    /// Whether inertia, damping and skew explain the responses.
    pub fn is_rigid(&self) -> bool {
        self.misfit <= RIGID
    }

    /// `delta` to certify with, in N m s/rad: the lower end of the damping of a rigid device. `None`
    /// where that is not positive, and for a device that is not rigid: no hand held it, and its
    /// damping in a hand cannot be measured from the motor alone (theory, section 3.2).
    pub fn passivity(&self) -> Option<f64> {
        (self.is_rigid() && self.damping.lo > 0.0).then_some(self.damping.lo)
    }
}

/// Fits the disk and the rigid device to the responses of a record with so long a period in s.
///
/// The skew stays in the model only where it is significant: three unknowns determine the damping
/// less well than two.
pub fn identify(
    period: f64,
    found: usize,
    responses: Vec<Response>,
    mut left_out: Vec<LeftOut>,
) -> Result<Identification, IdentifyError> {
    let stands_out =
        |r: &Response| r.counts >= LEAST_COUNTS && r.deviation < 0.5 * r.impedance().norm();
    let (responses, lost): (Vec<_>, Vec<_>) = responses.into_iter().partition(stands_out);
    left_out.extend(lost.iter().map(lost_in_noise));
    let usable = responses.len();
    let too_few = |left_out: Vec<LeftOut>| IdentifyError::TooFew { found, usable, left_out };
    if usable < 3 {
        return Err(too_few(left_out));
    }
    let Some((fit, skew, responses)) = without_images(period, &responses) else {
        return Err(too_few(left_out));
    };
    let disk = disk(&responses);
    let (b, m, turn) =
        (fit.unknowns[DAMPING], fit.unknowns[INERTIA], disk.omega * fit.unknowns[SKEW]);
    Ok(Identification {
        inertia: fit.estimate(INERTIA),
        damping: fit.estimate(DAMPING),
        skew,
        disk,
        bias: b * turn.cos() - m * disk.omega * turn.sin() - b,
        misfit: fit.misfit,
        responses,
        left_out,
    })
}

fn lost_in_noise(response: &Response) -> LeftOut {
    let counts = significant(response.counts, 2);
    let reason = format!(
        "its motion of {counts} counts is below quantisation and noise: use a larger torque, or a \
         longer tone"
    );
    LeftOut::new(response.omega, reason)
}

/// The fit, the skew and the responses without the images of the held torque, which are known once
/// inertia and damping are.
fn without_images(period: f64, measured: &[Response]) -> Option<(Fit, Estimate, Vec<Response>)> {
    let mut responses = measured.to_vec();
    let (mut fit, mut skew) = rigid(&responses)?;
    for _ in 0..IMAGE_PASSES {
        let (b, m) = (fit.unknowns[DAMPING], fit.unknowns[INERTIA]);
        let corrected = |r: &Response| {
            let admittance = r.admittance / images(r.omega, period, m, b);
            Response { admittance, ..*r }
        };
        responses = measured.iter().map(corrected).collect();
        (fit, skew) = rigid(&responses)?;
    }
    Some((fit, skew, responses))
}

fn rigid(responses: &[Response]) -> Option<(Fit, Estimate)> {
    let skewed = Fit::of(responses, true)?;
    let skew = skewed.estimate(SKEW);
    let fit = if skew.is_significant() { skewed } else { Fit::of(responses, false)? };
    Some((fit, skew))
}

/// The response that is nearest to the rim is the one with the smallest lower end.
fn disk(responses: &[Response]) -> Disk {
    // Normal distribution: the deviation of each response rests on many samples.
    let quantile = student(1e6);
    let rim = |r: &Response| {
        let delta = r.impedance().re;
        Disk { delta, lo: delta - quantile * r.deviation, omega: r.omega }
    };
    let nearer = |a: Disk, b: Disk| if b.delta < a.delta { b } else { a };
    let none = Disk { delta: f64::INFINITY, lo: f64::INFINITY, omega: 0.0 };
    let nearest = responses.iter().map(rim).fold(none, nearer);
    let lo = responses.iter().map(|r| rim(r).lo).fold(f64::INFINITY, f64::min);
    Disk { lo, ..nearest }
}

const DAMPING: usize = 0;
const INERTIA: usize = 1;
const SKEW: usize = 2;

/// Least squares of `1/J = (b + j w m) e^(j w t0)`, each response weighted by its deviation.
struct Fit {
    /// `b`, `m`, `t0`.
    unknowns: Vector3<f64>,
    deviations: Vector3<f64>,
    misfit: f64,
    freedom: f64,
}

impl Fit {
    fn of(responses: &[Response], with_skew: bool) -> Option<Self> {
        // Without skew the problem is linear, and without inertia a skew has no effect: so in turn.
        let mut unknowns = System::at(responses, &Vector3::zeros(), false).step()?;
        let mut system = System::at(responses, &unknowns, with_skew);
        for _ in 0..ITERATIONS {
            unknowns += system.step()?;
            system = System::at(responses, &unknowns, with_skew);
        }
        let count = if with_skew { 3.0 } else { 2.0 };
        let freedom = 2.0 * responses.len() as f64 - count;
        let misfit = system.squares / freedom;
        // Where the model fits worse than the noise allows, the intervals grow accordingly.
        let covariance = system.covariance()? * misfit.max(1.0);
        let deviations = covariance.diagonal().map(f64::sqrt);
        let usable = unknowns.iter().chain(&deviations).all(|value| value.is_finite());
        usable.then_some(Self { unknowns, deviations, misfit, freedom })
    }

    fn estimate(&self, index: usize) -> Estimate {
        let (value, reach) = (self.unknowns[index], student(self.freedom) * self.deviations[index]);
        Estimate { value, lo: value - reach, hi: value + reach }
    }
}

/// Two-sided quantile of Student's distribution.
fn student(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom)
        .map_or(f64::INFINITY, |student| student.inverse_cdf(0.5 + 0.5 * CONFIDENCE))
}

/// The normal equations around some unknowns, in units in which all three are near 1.
struct System {
    matrix: Matrix3<f64>,
    right: Vector3<f64>,
    units: Vector3<f64>,
    squares: f64,
}

impl System {
    fn at(responses: &[Response], unknowns: &Vector3<f64>, with_skew: bool) -> Self {
        let fastest = responses.iter().map(|r| r.omega).fold(0.0, f64::max);
        let largest = responses.iter().map(|r| r.impedance().norm()).fold(0.0, f64::max);
        let units = Vector3::new(largest, largest / fastest, 1.0 / fastest);
        let mut system =
            Self { matrix: Matrix3::zeros(), right: Vector3::zeros(), units, squares: 0.0 };
        for response in responses {
            system.add(response, unknowns, with_skew);
        }
        if !with_skew {
            // A fixed unknown: its equation keeps it unchanged.
            system.matrix[(SKEW, SKEW)] = 1.0;
        }
        system
    }

    fn add(&mut self, response: &Response, unknowns: &Vector3<f64>, with_skew: bool) {
        let (omega, measured) = (response.omega, response.impedance());
        let turn = Complex::from_polar(1.0, omega * unknowns[SKEW]);
        let j_omega = Complex::new(0.0, omega);
        let model = (unknowns[DAMPING] + j_omega * unknowns[INERTIA]) * turn;
        let skew = if with_skew { j_omega * model } else { Complex::from(0.0) };
        let slopes = [turn, j_omega * turn, skew];
        let weight = 1.0 / response.deviation.max(FLOOR * measured.norm());
        let residual = (measured - model) * weight;
        self.squares += residual.norm_sqr();
        for part in [|z: Complex<f64>| z.re, |z: Complex<f64>| z.im] {
            let row = Vector3::from_fn(|i, _| part(slopes[i]) * weight * self.units[i]);
            self.matrix += row * row.transpose();
            self.right += row * part(residual);
        }
    }

    fn step(&self) -> Option<Vector3<f64>> {
        Some(self.matrix.cholesky()?.solve(&self.right).component_mul(&self.units))
    }

    fn covariance(&self) -> Option<Matrix3<f64>> {
        let units = Matrix3::from_diagonal(&self.units);
        Some(units * self.matrix.cholesky()?.inverse() * units)
    }
}
