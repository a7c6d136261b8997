//! Methods for an index and a verdict: by formula, by enclosure, on a grid, by roots.

use std::f64::consts::PI;

use haptic_servo::passivity::discrete::{RealPart, index_near, index_within};
use haptic_servo::passivity::interval::Interval;
use haptic_servo::passivity::poles::IndexError;
use haptic_servo::passivity::polynomial::Polynomial;
use haptic_servo::passivity::transfer::Transfer;
use nalgebra::Complex;

use super::environments::{Environment, PERIOD};
use super::polynomials::{monomials, real_part, roots, squared};
use crate::closed_form;
use crate::studies::failures::method_result::MethodVerdict;

/// Coarsest angle of a logarithmic grid in rad.
const NEAREST: f64 = 1e-6;
/// A root with at most this imaginary part counts as real.
const REAL: f64 = 1e-6;

/// A method's result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IndexResult {
    /// Bounds on the index in N m s/rad, one number twice if the method has no bounds; `None` if it
    /// has no result.
    pub alpha: Option<(f64, f64)>,
    /// Whether the environment is passive on the device.
    pub verdict: MethodVerdict,
}

/// A method for an index and a verdict.
#[derive(Clone, Debug)]
pub enum IndexMethod {
    /// The formula of theory, section 5.
    ClosedForm,
    /// The certificate's enclosure with this relative width.
    Enclosure(f64),
    /// The certificate's enclosure until it is clear whether it will be a proof; an unproved scene
    /// is rejected, and the index is not searched.
    Decision,
    /// The least value on a grid.
    Grid(Grid),
    /// Zeros of the derivative as eigenvalues of a companion matrix.
    Roots,
}

/// Points on the upper half of the circle, with `z / (z - 1)` there.
#[derive(Clone, Debug)]
pub struct Grid {
    points: Vec<(Complex<f64>, Complex<f64>)>,
}

impl Grid {
    /// A grid of `count` points, the last at -1, evenly spaced in their angles or in the logarithms of the
    /// angles.
    pub fn new(count: usize, is_logarithmic: bool) -> Self {
        let angle = |i: usize| {
            let part = (i + 1) as f64 / count as f64;
            if is_logarithmic { PI * (NEAREST / PI).powf(1.0 - part) } else { PI * part }
        };
        let point = |angle: f64| {
            let kernel = Complex::new(0.5, -0.5 / (0.5 * angle).tan());
            (Complex::from_polar(1.0, angle), kernel)
        };
        Self { points: (0..count).map(angle).map(point).collect() }
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    fn least(&self, environment: &Environment) -> f64 {
        let horner = |values: &[f64], z: Complex<f64>| {
            values.iter().fold(Complex::ZERO, |sum, &value| sum * z + value)
        };
        let real = |&(z, kernel): &(Complex<f64>, Complex<f64>)| {
            let shifted = (0..environment.delay).fold(kernel, |value, _| value * z.conj());
            (shifted * horner(&environment.numerator, z) / horner(&environment.denominator, z)).re
        };
        PERIOD * self.points.iter().map(real).fold(f64::INFINITY, f64::min)
    }
}

impl IndexMethod {
    /// Its result for an environment on a device of passivity `delta`; `None` if it does not cover
    /// such environments.
    pub fn evaluate(&self, environment: &Environment, delta: f64) -> Option<IndexResult> {
        let period = Interval::exact(PERIOD);
        match self {
            Self::ClosedForm => {
                let (stiffness, damping) = environment.wall?;
                let (k, b) = (Interval::exact(stiffness), Interval::exact(damping));
                let alpha = match damping {
                    0.0 => closed_form::delayed_spring(k, period, environment.delay),
                    _ => closed_form::damper_wall(k, b, period, environment.delay)?,
                };
                Some(enclosed(alpha, delta))
            }
            Self::Enclosure(tolerance) => {
                Some(proved(index_within(transfer(environment), period, false, *tolerance), delta))
            }
            Self::Decision => {
                let limit = Interval::exact(delta);
                let found = proved(index_near(transfer(environment), period, false, limit), delta);
                let verdict = MethodVerdict::of(found.verdict == MethodVerdict::Safe);
                Some(IndexResult { alpha: None, verdict })
            }
            Self::Grid(grid) => Some(seen(environment, delta, || Some(grid.least(environment)))),
            Self::Roots => Some(seen(environment, delta, || least_at_roots(environment))),
        }
    }
}

fn transfer(environment: &Environment) -> Transfer {
    let polynomial = |values: &[f64]| Polynomial::descending(values, false);
    Transfer {
        shift: -(environment.delay as i32),
        ..Transfer::new(polynomial(&environment.numerator), polynomial(&environment.denominator))
    }
}

fn enclosed(alpha: Interval, delta: f64) -> IndexResult {
    let verdict = match () {
        () if alpha.hi() < delta => MethodVerdict::Safe,
        () if alpha.lo() >= delta => MethodVerdict::Unsafe,
        () => MethodVerdict::Undecided,
    };
    IndexResult { alpha: Some((alpha.lo(), alpha.hi())), verdict }
}

fn proved(found: Result<RealPart, IndexError>, delta: f64) -> IndexResult {
    match found {
        Ok(found) => enclosed(found.minimum, delta),
        Err(IndexError::Undecided(_)) => {
            IndexResult { alpha: None, verdict: MethodVerdict::Undecided }
        }
        Err(_) => IndexResult { alpha: None, verdict: MethodVerdict::Unsafe },
    }
}

/// The result of ordinary arithmetic: poles by their roots, the sign of the residue at 1, then the least real
/// part.
fn seen(environment: &Environment, delta: f64, least: impl Fn() -> Option<f64>) -> IndexResult {
    let nothing = |verdict| IndexResult { alpha: None, verdict };
    let Some(poles) = roots(&environment.denominator) else {
        return nothing(MethodVerdict::Undecided);
    };
    let at_one = |values: &[f64]| values.iter().sum::<f64>();
    let residue = at_one(&environment.numerator) / at_one(&environment.denominator);
    if poles.iter().any(|pole| pole.norm() >= 1.0) || residue < 0.0 {
        return nothing(MethodVerdict::Unsafe);
    }
    match least() {
        Some(least) => IndexResult {
            alpha: Some((-least, -least)),
            verdict: MethodVerdict::of(-least < delta),
        },
        None => nothing(MethodVerdict::Undecided),
    }
}

/// The least `T p / (2 r)` at the ends and the real zeros of its derivative.
fn least_at_roots(environment: &Environment) -> Option<f64> {
    let p = monomials(&real_part(environment));
    let r = monomials(&squared(&environment.denominator));
    let derivative = p.slope().times(&r).minus(&p.times(&r.slope()));
    let found = roots(&derivative.descending())?;
    let inside = found.into_iter().filter(|z| z.im.abs() <= REAL && z.re.abs() < 1.0);
    let values = inside.map(|z| z.re).chain([-1.0, 1.0]).map(|c| p.at(c) / r.at(c));
    Some(0.5 * PERIOD * values.fold(f64::INFINITY, f64::min))
}
