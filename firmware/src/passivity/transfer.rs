//! Transfer functions of the certificate: polynomials, with factors that are on the unit circle by
//! construction kept separately, so that they stay exact.

use super::interval::Interval;
use super::polynomial::{Polynomial, UnitRoot};

/// `G(z) = scale z^shift (z - 1)^ones (z + 1)^minus_ones numerator(z) / denominator(z)`.
///
/// The exponents may be negative: `ones = -1` is an integrator, `shift = -2` a delay of two
/// samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer {
    /// Constant factor.
    pub scale: Interval,
    /// Power of `z`.
    pub shift: i32,
    /// Power of `z - 1`.
    pub ones: i32,
    /// Power of `z + 1`.
    pub minus_ones: i32,
    /// Numerator.
    pub numerator: Polynomial,
    /// Denominator.
    pub denominator: Polynomial,
}

/// The reason why a transfer function could not be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unbuildable {
    /// More zeros than poles: the output would need future input.
    Improper,
    /// The denominator's leading coefficient vanishes or may vanish.
    IllPosed,
    /// A number overflowed, or a degree is beyond [`super::polynomial::MAX_DEGREE`].
    OutOfRange,
    /// No transfer function: only a bound is stated.
    Unstated,
}

impl Transfer {
    /// `numerator / denominator` without further factors.
    pub const fn new(numerator: Polynomial, denominator: Polynomial) -> Self {
        Self { scale: Interval::ONE, shift: 0, ones: 0, minus_ones: 0, numerator, denominator }
    }

    /// Degree of the numerator minus that of the denominator, including all factors. A transfer function is
    /// causal if this is not positive.
    pub const fn relative_degree(&self) -> i32 {
        self.shift + self.ones + self.minus_ones + self.numerator.degree() as i32
            - self.denominator.degree() as i32
    }

    /// Value as `z` goes to infinity: the feedthrough.
    pub const fn feedthrough(&self) -> Interval {
        if self.numerator.is_zero() || self.relative_degree() < 0 {
            Interval::ZERO
        } else {
            self.scale.mul(self.numerator.leading()).div(self.denominator.leading())
        }
    }

    /// Checks that the function is causal and that its denominator certainly has the apparent degree.
    pub const fn check(&self) -> Result<(), Unbuildable> {
        if self.denominator.is_zero() || self.denominator.leading().contains(0.0) {
            return Err(Unbuildable::IllPosed);
        }
        if !self.numerator.is_finite() || !self.denominator.is_finite() || !self.scale.is_finite() {
            return Err(Unbuildable::OutOfRange);
        }
        if !self.numerator.is_zero() && self.relative_degree() > 0 {
            return Err(Unbuildable::Improper);
        }
        Ok(())
    }

    /// `(T z / (z - 1)) G`: from backward-difference velocity instead of position (theory,
    /// section 2).
    pub const fn from_velocity(&self, period: Interval) -> Self {
        Self { scale: self.scale.mul(period), shift: self.shift + 1, ones: self.ones - 1, ..*self }
    }

    /// `1 / G`.
    pub const fn inverse(self) -> Self {
        Self {
            scale: Interval::ONE.div(self.scale),
            shift: -self.shift,
            ones: -self.ones,
            minus_ones: -self.minus_ones,
            numerator: self.denominator,
            denominator: self.numerator,
        }
    }

    /// `G / (1 + compliance G)`: the controller behind a coupling of that compliance. With
    /// `V - T/(2 delta)` as compliance it is `E'` of theory, section 4.1.
    #[inline(never)]
    pub const fn behind(&self, compliance: Interval) -> Result<Self, Unbuildable> {
        let Some(mut numerator) = self.numerator_with_roots(self.shift, self.ones, self.minus_ones)
        else {
            return Err(Unbuildable::OutOfRange);
        };
        let Some(denominator) = self.denominator_with_roots() else {
            return Err(Unbuildable::OutOfRange);
        };
        numerator = numerator.scaled(self.scale.mul(compliance));
        let sum = denominator.plus(&numerator);
        // The leading coefficient is 1 + compliance G(inf), times the denominator's.
        if self.denominator.is_zero() || sum.coefficient(denominator.degree()).contains(0.0) {
            return Err(Unbuildable::IllPosed);
        }
        Ok(Self {
            scale: self.scale,
            shift: positive(self.shift),
            ones: positive(self.ones),
            minus_ones: positive(self.minus_ones),
            numerator: self.numerator,
            denominator: sum,
        })
    }

    /// `G / (1 + V G)` behind a coupling `V = numerator / denominator`.
    #[inline(never)]
    pub const fn behind_rational(
        &self,
        numerator: &Polynomial,
        denominator: &Polynomial,
    ) -> Result<Self, Unbuildable> {
        let out_of_range = Unbuildable::OutOfRange;
        let own = self.numerator_with_roots(self.shift, self.ones, self.minus_ones);
        let (Some(own), Some(poles)) = (own, self.denominator_with_roots()) else {
            return Err(out_of_range);
        };
        let (Some(own), Some(poles)) = (own.times(numerator), poles.times(denominator)) else {
            return Err(out_of_range);
        };
        let sum = poles.plus(&own.scaled(self.scale));
        if self.denominator.is_zero() || sum.coefficient(poles.degree()).contains(0.0) {
            return Err(Unbuildable::IllPosed);
        }
        let Some(zeros) = self.numerator.times(denominator) else { return Err(out_of_range) };
        Ok(Self {
            scale: self.scale,
            shift: positive(self.shift),
            ones: positive(self.ones),
            minus_ones: positive(self.minus_ones),
            numerator: zeros,
            denominator: sum,
        })
    }

    /// `self + other`; `None` if the result has too high a degree.
    #[inline(never)]
    pub const fn plus(&self, other: &Self) -> Option<Self> {
        let ones = positive(if self.ones < other.ones { self.ones } else { other.ones });
        let (Some(left), Some(right)) = (self.summand(other, ones), other.summand(self, ones))
        else {
            return None;
        };
        let Some(denominator) = self.common_denominator(other) else { return None };
        Some(Self { ones, ..Self::new(left.plus(&right), denominator) })
    }

    /// Its share of the numerator of a sum over the common denominator, without the common zeros
    /// at 1.
    #[inline(never)]
    const fn summand(&self, other: &Self, ones: i32) -> Option<Polynomial> {
        let own = self.numerator_with_roots(self.shift, self.ones - ones, self.minus_ones);
        let (Some(own), Some(others)) = (own, other.denominator_with_roots()) else { return None };
        own.scaled(self.scale).times(&others)
    }

    #[inline(never)]
    const fn common_denominator(&self, other: &Self) -> Option<Polynomial> {
        let (own, others) = (self.denominator_with_roots(), other.denominator_with_roots());
        let (Some(own), Some(others)) = (own, others) else { return None };
        own.times(&others)
    }

    const fn numerator_with_roots(&self, shift: i32, ones: i32, minus: i32) -> Option<Polynomial> {
        with_roots(&self.numerator, positive(shift), positive(ones), positive(minus))
    }

    const fn denominator_with_roots(&self) -> Option<Polynomial> {
        with_roots(
            &self.denominator,
            positive(-self.shift),
            positive(-self.ones),
            positive(-self.minus_ones),
        )
    }
}

const fn positive(value: i32) -> i32 {
    if value > 0 { value } else { 0 }
}

const fn with_roots(p: &Polynomial, zero: i32, plus: i32, minus: i32) -> Option<Polynomial> {
    let Some(p) = p.shifted_up(zero as usize) else { return None };
    let Some(p) = p.times_unit_root(UnitRoot::Plus, plus as usize) else { return None };
    p.times_unit_root(UnitRoot::Minus, minus as usize)
}
