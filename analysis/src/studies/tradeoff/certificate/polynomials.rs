//! Polynomials in doubles, without bounds on rounding errors.

use nalgebra::{Complex, DMatrix};

use super::environments::{Environment, multiply};
use crate::stability::eigenvalues;

/// Ascending coefficients.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ascending(Vec<f64>);

impl Ascending {
    pub(super) fn at(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, value| sum * x + value)
    }

    pub(super) fn slope(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self(terms.map(|(power, value)| power as f64 * value).collect())
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        Self(multiply(&self.0, &other.0))
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        let at = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(0.0);
        let longest = self.0.len().max(other.0.len());
        Self((0..longest).map(|i| at(&self.0, i) - at(&other.0, i)).collect())
    }

    pub(super) fn descending(&self) -> Vec<f64> {
        self.0.iter().rev().copied().collect()
    }
}

/// Roots as eigenvalues of the companion matrix; `None` where they are not found.
pub(super) fn roots(descending: &[f64]) -> Option<Vec<Complex<f64>>> {
    let start = descending.iter().position(|&value| value != 0.0);
    let Some(monic) = start.map(|start| &descending[start..]) else { return Some(Vec::new()) };
    if monic.len() == 1 { Some(Vec::new()) } else { eigenvalues(&companion(monic)).ok() }
}

/// The matrix whose eigenvalues are the roots of a polynomial, of which the first coefficient is not 0.
fn companion(descending: &[f64]) -> DMatrix<f64> {
    let degree = descending.len() - 1;
    DMatrix::from_fn(degree, degree, |i, j| match (i, j) {
        (0, j) => -descending[j + 1] / descending[0],
        (i, j) if i == j + 1 => 1.0,
        _ => 0.0,
    })
}

/// `A + (1 + c) B` of theory, section 7, as a Chebyshev series: twice the real part of
/// `z / (z - 1) E` times `abs(D)^2`.
pub(super) fn real_part(environment: &Environment) -> Vec<f64> {
    let ascending = |values: &[f64], shift: usize| -> Vec<f64> {
        std::iter::repeat_n(0.0, shift).chain(values.iter().rev().copied()).collect()
    };
    let n = ascending(&environment.numerator, 0);
    let d = ascending(&environment.denominator, environment.delay);
    let mut series = vec![0.0; n.len().max(d.len()) + 1];
    for (i, a) in n.iter().enumerate() {
        for (j, b) in d.iter().enumerate() {
            let (lag, product) = (i.abs_diff(j), a * b);
            series[lag] += product;
            // (1 + c) U_{m-1} = 1 + 2 T_1 + .. + 2 T_{m-1} + T_m
            let signed = if i > j { product } else { -product };
            for (power, term) in series.iter_mut().enumerate().take(lag + 1).filter(|_| lag > 0) {
                *term += if power == 0 || power == lag { signed } else { 2.0 * signed };
            }
        }
    }
    series
}

/// `abs(D)^2` as a Chebyshev series.
pub(super) fn squared(values: &[f64]) -> Vec<f64> {
    let mut series = vec![0.0; values.len()];
    for (i, a) in values.iter().enumerate() {
        for (j, b) in values.iter().enumerate() {
            series[i.abs_diff(j)] += a * b;
        }
    }
    series
}

/// A Chebyshev series in powers.
pub(super) fn monomials(series: &[f64]) -> Ascending {
    let (mut before, mut chebyshev) = (Ascending(vec![1.0]), Ascending(vec![0.0, 1.0]));
    let mut sum = Ascending(Vec::new());
    for value in series {
        let term = Ascending(before.0.iter().map(|coefficient| -value * coefficient).collect());
        sum = sum.minus(&term);
        let next = Ascending(vec![0.0, 2.0]).times(&chebyshev).minus(&before);
        (before, chebyshev) = (chebyshev, next);
    }
    sum
}
