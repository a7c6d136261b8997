//! Polynomials with rational coefficients.

use crate::exact::{Q, q};
use crate::remainders::Chain;
use num_traits::{One, Zero};

/// A polynomial, ascending powers, without zeros at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Poly(Vec<Q>);

impl Poly {
    /// From ascending coefficients.
    pub fn ascending(mut coefficients: Vec<Q>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// From descending coefficients.
    pub fn descending(coefficients: &[Q]) -> Self {
        Self::ascending(coefficients.iter().rev().cloned().collect())
    }

    /// From descending coefficients in `f64`, which are finite.
    pub fn of(descending: &[f64]) -> Self {
        Self::ascending(descending.iter().rev().copied().map(q).collect())
    }

    /// From ascending whole numbers.
    pub fn integers(coefficients: &[i64]) -> Self {
        Self::ascending(coefficients.iter().map(|&c| Q::from_integer(c.into())).collect())
    }

    /// Ascending coefficients.
    pub fn coefficients(&self) -> &[Q] {
        &self.0
    }

    /// Whether every coefficient is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Degree; 0 for the zero polynomial too.
    pub fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    /// Coefficient of the highest power; zero for the zero polynomial.
    pub fn leading(&self) -> Q {
        self.0.last().cloned().unwrap_or_else(Q::zero)
    }

    /// Value at `x`.
    pub fn at(&self, x: &Q) -> Q {
        self.0.iter().rev().fold(Q::zero(), |sum, c| sum * x + c)
    }

    /// Sum.
    pub fn plus(&self, other: &Self) -> Self {
        let longest = self.0.len().max(other.0.len());
        let at = |p: &Self, i: usize| p.0.get(i).cloned().unwrap_or_else(Q::zero);
        Self::ascending((0..longest).map(|i| at(self, i) + at(other, i)).collect())
    }

    /// Every coefficient times `factor`.
    pub fn scaled(&self, factor: &Q) -> Self {
        Self::ascending(self.0.iter().map(|c| c * factor).collect())
    }

    /// Product.
    pub fn times(&self, other: &Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self(Vec::new());
        }
        let mut product = vec![Q::zero(); self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Self::ascending(product)
    }

    /// Times the `n`-th power of the variable.
    pub fn raised(&self, n: usize) -> Self {
        let zeros = std::iter::repeat_with(Q::zero).take(n);
        Self::ascending(zeros.chain(self.0.iter().cloned()).collect())
    }

    /// Quotient of an exact division, and the remainder.
    ///
    /// # Panics
    /// If `divisor` is zero.
    pub fn divided(&self, divisor: &Self) -> (Self, Self) {
        assert!(!divisor.is_zero(), "division by the zero polynomial");
        let mut rest = self.0.clone();
        let mut quotient = vec![Q::zero(); rest.len().saturating_sub(divisor.degree())];
        for shift in (0..quotient.len()).rev() {
            let factor = &rest[shift + divisor.degree()] / divisor.leading();
            for (i, c) in divisor.0.iter().enumerate() {
                rest[shift + i] -= &factor * c;
            }
            quotient[shift] = factor;
        }
        (Self::ascending(quotient), Self::ascending(rest))
    }

    /// Derivative.
    pub fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self::ascending(terms.map(|(i, c)| c * Q::from_integer(i.into())).collect())
    }

    /// Coefficients in reverse: the roots become their reciprocals, and roots at zero vanish.
    pub fn reversed(&self) -> Self {
        Self::ascending(self.0.iter().rev().cloned().collect())
    }

    /// Leading coefficient 1.
    pub fn monic(&self) -> Self {
        if self.is_zero() { self.clone() } else { self.scaled(&(Q::one() / self.leading())) }
    }

    /// Greatest common divisor, leading coefficient 1.
    pub fn gcd(&self, other: &Self) -> Self {
        if other.is_zero() {
            return self.monic();
        }
        if self.is_zero() {
            return other.monic();
        }
        Chain::of(self, other).last().monic()
    }

    /// Without the factor `other`, as often as it divides; and how often that was.
    pub fn without(&self, other: &Self) -> (Self, usize) {
        let (mut rest, mut count) = (self.clone(), 0);
        while !rest.is_zero() && rest.degree() >= other.degree() {
            let (quotient, remainder) = rest.divided(other);
            if !remainder.is_zero() {
                break;
            }
            (rest, count) = (quotient, count + 1);
        }
        (rest, count)
    }
}
