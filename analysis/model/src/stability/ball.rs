//! Numbers of a thousand bits, each with a bound on its error.
//!
//! Eigenvalues of clustered roots lose most digits of a double, and an eigenvalue next to 1 is not told from
//! 1. With these bounds a result is an enclosure; where it is too wide, a caller sees it.

use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::Complex;
use num_bigint::{BigInt, Sign};
use num_traits::{One, Signed, ToPrimitive, Zero};

/// Bits behind the point.
const BITS: usize = 1024;

/// All numbers within `error` of `middle`, both in units of `2^-BITS`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    middle: BigInt,
    error: BigInt,
}

impl Ball {
    /// A finite number; 0 if it is not finite.
    pub fn of(value: f64) -> Self {
        if !value.is_finite() {
            return Self::zero();
        }
        let bits = value.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i64;
        let fraction = bits & ((1 << 52) - 1);
        let digits = if exponent == 0 { fraction } else { fraction | (1 << 52) };
        // The last bit of the digits is 2^(exponent - 1075).
        let shift = exponent.max(1) - 1075 + BITS as i64;
        let size = BigInt::from(digits);
        let (middle, error) = if shift >= 0 {
            (size << shift as usize, BigInt::zero())
        } else {
            (size >> shift.unsigned_abs() as usize, BigInt::one())
        };
        Self { middle: if value < 0.0 { -middle } else { middle }, error }
    }

    /// Zero without error.
    pub fn zero() -> Self {
        Self { middle: BigInt::zero(), error: BigInt::zero() }
    }

    /// One without error.
    pub fn one() -> Self {
        Self::of(1.0)
    }

    /// Whether it is zero without error.
    pub fn is_zero(&self) -> bool {
        self.middle.is_zero() && self.error.is_zero()
    }

    /// The sign of all its numbers, if they have one.
    pub fn sign(&self) -> Option<Sign> {
        (self.middle.abs() > self.error).then(|| self.middle.sign())
    }

    /// The size, of which all numbers are at least 0.
    pub fn abs(&self) -> Self {
        Self { middle: self.middle.abs(), error: self.error.clone() }
    }

    /// The number in the middle, without the error.
    fn middle(&self) -> Self {
        Self { middle: self.middle.clone(), error: BigInt::zero() }
    }

    /// The number in the middle, rounded.
    fn to_f64(&self) -> f64 {
        /// Bits behind the point that are kept.
        const KEPT: usize = 128;
        let kept = (&self.middle >> (BITS - KEPT)).to_f64();
        kept.map_or(f64::NAN, |kept| kept * 2_f64.powi(-(KEPT as i32)))
    }

    /// The quotient; `None` if the divisor may be 0.
    pub fn over(&self, divisor: &Self) -> Option<Self> {
        let least = divisor.middle.abs() - &divisor.error;
        if !least.is_positive() {
            return None;
        }
        let middle = (&self.middle << BITS) / &divisor.middle;
        // |a / b - m| <= (e_a + |m| e_b) / |b|, and the quotient's own rounding.
        let off = (&self.error << BITS) + (middle.abs() + 1) * &divisor.error;
        Some(Self { middle, error: off / least + 2 })
    }
}

impl Add for &Ball {
    type Output = Ball;

    fn add(self, other: Self) -> Ball {
        Ball { middle: &self.middle + &other.middle, error: &self.error + &other.error }
    }
}

impl Sub for &Ball {
    type Output = Ball;

    fn sub(self, other: Self) -> Ball {
        Ball { middle: &self.middle - &other.middle, error: &self.error + &other.error }
    }
}

impl Neg for &Ball {
    type Output = Ball;

    fn neg(self) -> Ball {
        Ball { middle: -&self.middle, error: self.error.clone() }
    }
}

impl Mul for &Ball {
    type Output = Ball;

    fn mul(self, other: Self) -> Ball {
        if self.is_zero() || other.is_zero() {
            return Ball::zero();
        }
        let off =
            self.middle.abs() * &other.error + (other.middle.abs() + &other.error) * &self.error;
        Ball { middle: (&self.middle * &other.middle) >> BITS, error: (off >> BITS) + 2 }
    }
}

#[derive(Clone, Debug)]
pub struct BallMatrix {
    size: usize,
    entries: Vec<Ball>,
}

impl BallMatrix {
    /// From its entries, by row and column.
    pub fn from_fn(size: usize, entry: impl Fn(usize, usize) -> Ball) -> Self {
        let entries = (0..size * size).map(|i| entry(i / size, i % size)).collect();
        Self { size, entries }
    }

    pub fn at(&self, row: usize, column: usize) -> &Ball {
        &self.entries[row * self.size + column]
    }

    fn identity(size: usize) -> Self {
        Self::from_fn(size, |i, j| if i == j { Ball::one() } else { Ball::zero() })
    }

    fn plus(&self, other: &Self) -> Self {
        Self::from_fn(self.size, |i, j| self.at(i, j) + other.at(i, j))
    }

    fn scaled(&self, factor: &Ball) -> Self {
        Self::from_fn(self.size, |i, j| self.at(i, j) * factor)
    }

    pub fn times(&self, other: &Self) -> Self {
        Self::from_fn(self.size, |i, j| {
            (0..self.size).fold(Ball::zero(), |sum, k| &sum + &(self.at(i, k) * other.at(k, j)))
        })
    }

    /// The matrix exponential: Taylor's series of a part so small that `ratio` bounds it, squared.
    ///
    /// `norm` is a bound on the largest sum of sizes in a row.
    pub fn exponential(&self, norm: f64) -> Self {
        /// The part has at most this norm, as a power of 2.
        const SMALL: i32 = -24;
        /// Terms after which the remainder is below the last bit: each is `2^-24` of the one before.
        const TERMS: i32 = 48;
        let halvings = (norm.max(1e-300).log2().ceil() as i32 + 1 - SMALL).max(0);
        let part = self.scaled(&Ball::of(2_f64.powi(-halvings)));
        let mut sum = Self::identity(self.size);
        let mut term = sum.clone();
        for n in 1..=TERMS {
            let next = term.times(&part);
            term = Self::from_fn(self.size, |i, j| {
                next.at(i, j).over(&Ball::of(f64::from(n))).unwrap_or_else(Ball::zero)
            });
            sum = sum.plus(&term);
        }
        for entry in &mut sum.entries {
            entry.error += 1;
        }
        (0..halvings).fold(sum, |square, _| square.times(&square))
    }

    /// `det(z - matrix)`, ascending, by the recursion of Faddeev and LeVerrier.
    pub fn characteristic(&self) -> Vec<Ball> {
        self.with_adjugates(0, &[]).0
    }

    /// The same, and a row of the adjugate of `z - matrix` times each column, ascending.
    pub fn with_adjugates(&self, row: usize, columns: &[Vec<Ball>]) -> (Vec<Ball>, Vec<Vec<Ball>>) {
        let mut coefficients = vec![Ball::zero(); self.size + 1];
        coefficients[self.size] = Ball::one();
        let mut adjugates = vec![vec![Ball::zero(); self.size]; columns.len()];
        let mut product = Self::from_fn(self.size, |_, _| Ball::zero());
        for k in 1..=self.size {
            let last = coefficients[self.size + 1 - k].clone();
            // The adjugate's coefficient of this power.
            let inner = product.plus(&Self::identity(self.size).scaled(&last));
            for (adjugate, column) in adjugates.iter_mut().zip(columns) {
                let terms = (0..self.size).map(|i| inner.at(row, i) * &column[i]);
                adjugate[self.size - k] = terms.fold(Ball::zero(), |sum, term| &sum + &term);
            }
            product = self.times(&inner);
            let trace = (0..self.size).fold(Ball::zero(), |sum, i| &sum + product.at(i, i));
            let quotient = trace.over(&Ball::of(k as f64)).unwrap_or_else(Ball::zero);
            coefficients[self.size - k] = -&quotient;
        }
        (coefficients, adjugates)
    }
}

pub fn product(a: &[Ball], b: &[Ball]) -> Vec<Ball> {
    let mut out = vec![Ball::zero(); (a.len() + b.len()).saturating_sub(1)];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] = &out[i + j] + &(x * y);
        }
    }
    out
}

pub fn sum(a: &[Ball], b: &[Ball]) -> Vec<Ball> {
    let zero = Ball::zero();
    let at = |p: &[Ball], i: usize| p.get(i).cloned().unwrap_or_else(|| zero.clone());
    (0..a.len().max(b.len())).map(|i| &at(a, i) + &at(b, i)).collect()
}

/// Whether all roots are smaller than `radius` in size, by the recursion of Schur and Cohn; `None` where the
/// errors of the coefficients leave it open.
pub fn roots_within(polynomial: &[Ball], radius: f64) -> Option<bool> {
    let radius = Ball::of(radius);
    let mut power = Ball::one();
    let mut p = Vec::with_capacity(polynomial.len());
    for coefficient in polynomial {
        p.push(coefficient * &power);
        power = &power * &radius;
    }
    while p.len() > 1 {
        let n = p.len() - 1;
        let reflection = p[0].over(&p[n])?;
        match (&reflection.abs() - &Ball::one()).sign()? {
            Sign::Minus => {}
            _ => return Some(false),
        }
        p = (1..=n).map(|i| &p[i] - &(&reflection * &p[n - i])).collect();
    }
    Some(true)
}

/// A polynomial and its derivative at a complex place.
fn with_slope(polynomial: &[Ball], [x, y]: &[Ball; 2]) -> [[Ball; 2]; 2] {
    let times = |[a, b]: &[Ball; 2]| [&(a * x) - &(b * y), &(a * y) + &(b * x)];
    let zero = || [Ball::zero(), Ball::zero()];
    polynomial.iter().rev().fold([zero(), zero()], |[value, slope], coefficient| {
        let ([a, b], [c, d]) = (times(&value), times(&slope));
        [[&a + coefficient, b], [&c + &value[0], &d + &value[1]]]
    })
}

/// The size of a root next to `near` that is larger than `radius`, to a thousandth of what it is larger by;
/// `None` where none is found or the errors of the coefficients leave it open.
///
/// Newton's steps lead to a place `z`; a polynomial `p` of degree `n` has a root within `n |p(z)/p'(z)|` of it
/// (its roots `r` have `p'/p = sum 1/(z - r)`).
pub fn root_beyond(polynomial: &[Ball], radius: f64, near: Complex<f64>) -> Option<f64> {
    const STEPS: usize = 12;
    /// Of the distance to the circle, within which the root has to be.
    const PART: f64 = 1e-3;
    let square = |[a, b]: &[Ball; 2]| &(a * a) + &(b * b);
    let mut z = [Ball::of(near.re), Ball::of(near.im)];
    for _ in 0..STEPS {
        let [[a, b], slope] = with_slope(polynomial, &z);
        let [c, d] = &slope;
        let size = square(&slope);
        let step = [&(&a * c) + &(&b * d), &(&b * c) - &(&a * d)];
        for (z, step) in z.iter_mut().zip(step) {
            *z = (&*z - &step.over(&size)?).middle();
        }
    }
    let [value, slope] = with_slope(polynomial, &z);
    let found = square(&z).to_f64().sqrt();
    let off = Ball::of(PART * (found - radius).max(0.0));
    let degree = Ball::of(polynomial.len() as f64 - 1.0);
    let least = &Ball::of(radius) + &off;
    let is_larger = (&square(&z) - &(&least * &least)).sign() == Some(Sign::Plus);
    let reach = &(&off * &off) * &square(&slope);
    let is_near = (&reach - &(&(&degree * &degree) * &square(&value))).sign() == Some(Sign::Plus);
    (is_larger && is_near).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(roots: &[f64]) -> Vec<Ball> {
        roots
            .iter()
            .fold(vec![Ball::one()], |all, root| product(&all, &[Ball::of(-root), Ball::one()]))
    }

    /// Eight equal roots, of which doubles keep two digits.
    #[test]
    fn a_cluster_has_its_radius() {
        let cluster = polynomial(&[0.998; 8]);
        assert_eq!(roots_within(&cluster, 0.998 * (1.0 + 1e-15)), Some(true));
        assert_eq!(roots_within(&cluster, 0.998 * (1.0 - 1e-15)), Some(false));
        assert_eq!(roots_within(&cluster, 0.998), None);
    }

    /// A root a millionth outside of the circle, among seven that are as much inside.
    #[test]
    fn a_root_among_others_is_found_and_none_where_there_is_none() {
        let inside = [0.999_999, 0.999_998_9, 0.999_998, 0.999_997, 0.999_996, 0.999_995, 0.99];
        let near = Complex::new(1.000_000_98, 1e-9);
        let found = root_beyond(&polynomial(&[&[1.000_001], &inside[..]].concat()), 1.0, near);
        assert!(found.is_some_and(|found| (found - 1.000_001).abs() < 1e-12), "{found:?}");
        assert_eq!(root_beyond(&polynomial(&inside), 1.0, near), None);
        // On the circle itself.
        assert_eq!(root_beyond(&polynomial(&[1.0, 0.9]), 1.0, near), None);
    }

    #[test]
    fn the_characteristic_polynomial_has_the_eigenvalues() {
        let entries = [[2.0, 1.0, 0.0], [0.0, 3.0, -1.0], [0.0, 0.0, 0.5]];
        let found = BallMatrix::from_fn(3, |i, j| Ball::of(entries[i][j])).characteristic();
        for (found, should) in found.iter().zip(polynomial(&[2.0, 3.0, 0.5])) {
            assert!((found - &should).sign().is_none());
        }
    }

    /// `exp [[0, t], [-t, 0]]` is a rotation, and its powers return to the start.
    #[test]
    fn the_exponential_encloses_a_rotation() {
        let angle = 0.75;
        let generator =
            BallMatrix::from_fn(2, |i, j| Ball::of([[0.0, angle], [-angle, 0.0]][i][j]));
        let turned = generator.exponential(angle);
        for (entry, should) in [(turned.at(0, 0), angle.cos()), (turned.at(0, 1), angle.sin())] {
            let off = (entry - &Ball::of(should)).abs();
            assert_eq!((&off - &Ball::of(1e-15)).sign(), Some(Sign::Minus));
        }
        let square = &(turned.at(0, 0) * turned.at(0, 0)) + &(turned.at(0, 1) * turned.at(0, 1));
        assert!((&square - &Ball::one()).sign().is_none());
    }
}
