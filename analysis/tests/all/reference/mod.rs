//! Numbers of sixty digits and their matrix exponential, with nothing of the simulation in them.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};

/// Binary places behind the point.
const PLACES: u32 = 240;

/// A number in fixed point.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub struct Real(BigInt);

impl Real {
    /// The exact value of a float.
    pub fn of(value: f64) -> Self {
        let bits = value.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i64;
        let fraction = bits & ((1 << 52) - 1);
        let (mantissa, exponent) =
            if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
        let shift = exponent + i64::from(PLACES);
        let magnitude = BigInt::from(mantissa);
        let scaled = if shift >= 0 { magnitude << shift } else { magnitude >> -shift };
        Self(if value.is_sign_negative() { -scaled } else { scaled })
    }

    /// The nearest float, or nearly.
    pub fn to_f64(&self) -> f64 {
        let excess = (self.0.bits() as i64 - 64).max(0);
        let top = (self.0.clone() >> excess).to_f64().unwrap_or(f64::NAN);
        top * 2_f64.powi(excess as i32) * 2_f64.powi(-(PLACES as i32))
    }

    /// Sine and cosine, by their series after halving the angle until it is small.
    pub fn sin_cos(&self) -> (Self, Self) {
        let zero = Self::of(0.0);
        let turn = vec![vec![zero.clone(), self.clone()], vec![-self.clone(), zero]];
        let turned = exponential(&turn);
        (turned[0][1].clone(), turned[0][0].clone())
    }

    /// Clamped to a magnitude.
    pub fn limited(self, bound: &Self) -> Self {
        if self > *bound {
            bound.clone()
        } else if self < -bound.clone() {
            -bound.clone()
        } else {
            self
        }
    }
}

macro_rules! operations {
    ($($trait:ident $name:ident |$a:ident, $b:ident| $value:expr;)*) => {$(
        impl $trait for Real {
            type Output = Self;
            fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self($value)
            }
        }
        impl $trait<&Real> for &Real {
            type Output = Real;
            fn $name(self, other: &Real) -> Real {
                let ($a, $b) = (&self.0, &other.0);
                Real($value)
            }
        }
    )*};
}

operations! {
    Add add |a, b| a + b;
    Sub sub |a, b| a - b;
    Mul mul |a, b| (a * b) >> PLACES;
    Div div |a, b| (a << PLACES) / b;
}

impl Neg for Real {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// A square matrix.
pub type Matrix = Vec<Vec<Real>>;

/// Product of two.
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |row: &Vec<Real>, j: usize| {
        row.iter().zip(b).fold(Real::of(0.0), |sum, (x, row)| sum + x * &row[j])
    };
    a.iter().map(|row| (0..b.len()).map(|j| entry(row, j)).collect()).collect()
}

/// Product of a matrix with a vector.
pub fn image(a: &Matrix, x: &[Real]) -> Vec<Real> {
    a.iter().map(|row| row.iter().zip(x).fold(Real::of(0.0), |s, (a, x)| s + a * x)).collect()
}

/// `exp(A)` by its series: after so many halvings that it converges at once, and squared again.
pub fn exponential(a: &Matrix) -> Matrix {
    const HALVINGS: u32 = 24;
    let n = a.len();
    let identity = |i, j| Real::of(f64::from(u8::from(i == j)));
    let identity: Matrix = (0..n).map(|i| (0..n).map(|j| identity(i, j)).collect()).collect();
    let small: Matrix =
        a.iter().map(|row| row.iter().map(|x| Real(x.0.clone() >> HALVINGS)).collect()).collect();
    let (mut sum, mut term) = (identity.clone(), identity);
    for k in 1.. {
        term = product(&term, &small);
        term.iter_mut().flatten().for_each(|x| x.0 = &x.0 / k);
        if term.iter().flatten().all(|x| x.0.abs().is_zero()) {
            break;
        }
        for (sum, term) in sum.iter_mut().flatten().zip(term.iter().flatten()) {
            *sum = &*sum + term;
        }
    }
    for _ in 0..HALVINGS {
        sum = product(&sum, &sum);
    }
    sum
}

/// Coefficients of `det(z - A)`, ascending, by the traces of powers (Faddeev and LeVerrier).
pub fn characteristic(a: &Matrix) -> Vec<Real> {
    let n = a.len();
    let mut ascending = vec![Real::of(0.0); n + 1];
    ascending[n] = Real::of(1.0);
    let mut power: Matrix = vec![vec![Real::of(0.0); n]; n];
    for k in 1..=n {
        for (i, row) in power.iter_mut().enumerate() {
            row[i] = &row[i] + &ascending[n + 1 - k];
        }
        power = product(a, &power);
        let trace = (0..n).fold(Real::of(0.0), |sum, i| sum + power[i][i].clone());
        ascending[n - k] = -trace / Real::of(k as f64);
    }
    ascending
}

/// The root of a polynomial near `(re, im)`, by Newton's method to all digits, as its modulus.
pub fn modulus_of_root(ascending: &[Real], (re, im): (f64, f64)) -> f64 {
    type Complex = (Real, Real);
    let times = |a: &Complex, b: &Complex| -> Complex {
        (&a.0 * &b.0 - &a.1 * &b.1, &a.0 * &b.1 + &a.1 * &b.0)
    };
    let mut z = (Real::of(re), Real::of(im));
    for _ in 0..12 {
        let zero = || (Real::of(0.0), Real::of(0.0));
        let (mut value, mut slope) = (zero(), zero());
        for coefficient in ascending.iter().rev() {
            let moved = times(&slope, &z);
            slope = (moved.0 + value.0.clone(), moved.1 + value.1.clone());
            let moved = times(&value, &z);
            value = (moved.0 + coefficient.clone(), moved.1);
        }
        let size = &slope.0 * &slope.0 + &slope.1 * &slope.1;
        let conjugate = (slope.0.clone(), -slope.1.clone());
        let step = times(&value, &conjugate);
        z = (z.0 - step.0 / size.clone(), z.1 - step.1 / size);
    }
    (&z.0 * &z.0 + &z.1 * &z.1).to_f64().sqrt()
}
