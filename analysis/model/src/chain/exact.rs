//! Polynomials of whole numbers of any size.
//!
//! Where a chain has undamped resonances inside, twelve digits of its polynomials cancel. Exact arithmetic
//! loses none of them. The numbers of a chain are decimals: multiplied by a power of ten they are whole, and
//! all results computed from them are whole, too.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Pow, Zero};

/// `digits * 10^power`: the shortest decimal of a finite double, which is the number as the
/// user wrote it.
pub struct Decimal {
    digits: BigInt,
    power: i32,
}

impl Decimal {
    /// The decimal of a number; 0 if it is not finite.
    pub fn of(value: f64) -> Self {
        let text = format!("{value:e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or(("0", "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{fraction}").parse().unwrap_or_default();
        Self { digits, power: exponent.parse::<i32>().unwrap_or(0) - fraction.len() as i32 }
    }

    /// The power of ten that makes the number whole.
    pub fn places(&self) -> u32 {
        if self.digits.is_zero() { 0 } else { (-self.power).max(0).unsigned_abs() }
    }

    /// The number times `10^places`; `places` is at least [`Self::places`].
    pub fn whole(&self, places: u32) -> BigInt {
        let power = i64::from(self.power) + i64::from(places);
        &self.digits * BigInt::from(10).pow(power.max(0).unsigned_abs() as u32)
    }
}

/// A polynomial: coefficients in ascending powers, the last not zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial(Vec<BigInt>);

impl Polynomial {
    /// From ascending coefficients.
    pub fn new(mut coefficients: Vec<BigInt>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Degree; 0 for zero.
    pub fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    pub fn coefficient(&self, power: usize) -> BigInt {
        self.0.get(power).cloned().unwrap_or_default()
    }

    /// The highest power of the variable that divides it.
    pub fn trailing_zeros(&self) -> usize {
        self.0.iter().take_while(|coefficient| coefficient.is_zero()).count()
    }

    /// Divided by a power of the variable; the remainder is dropped.
    pub fn shifted_down(&self, power: usize) -> Self {
        Self(self.0.iter().skip(power).cloned().collect())
    }

    /// Times the variable.
    pub fn shifted_up(&self) -> Self {
        let zero = (!self.is_zero()).then(BigInt::zero);
        Self(zero.into_iter().chain(self.0.iter().cloned()).collect())
    }

    pub fn plus(&self, other: &Self) -> Self {
        let len = self.0.len().max(other.0.len());
        Self::new((0..len).map(|i| self.coefficient(i) + other.coefficient(i)).collect())
    }

    pub fn scaled(&self, factor: &BigInt) -> Self {
        Self::new(self.0.iter().map(|coefficient| coefficient * factor).collect())
    }

    pub fn times(&self, other: &Self) -> Self {
        let mut product = vec![BigInt::zero(); self.0.len() + other.0.len()];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Self::new(product)
    }

    pub fn derivative(&self) -> Self {
        Self::new(self.0.iter().enumerate().skip(1).map(|(i, a)| a * BigInt::from(i)).collect())
    }

    pub fn at(&self, x: &BigRational) -> BigRational {
        let zero = BigRational::zero();
        self.0.iter().rev().fold(zero, |sum, a| sum * x + BigRational::from(a.clone()))
    }
}
