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
    pub(crate) const ZERO: Self =
        Self::new(Polynomial::ZERO, Polynomial::ascending(&[Interval::ONE]));

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
        let (scale, shift, ones) = self.velocity_factors(period);
        Self { scale, shift, ones, ..*self }
    }

    /// The factor, and the powers of `z` and `z - 1`, of [`Transfer::from_velocity`].
    pub(super) const fn velocity_factors(&self, period: Interval) -> (Interval, i32, i32) {
        (self.scale.mul(period), self.shift + 1, self.ones - 1)
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
        let (mut numerator, mut sum) = (self.numerator, self.denominator);
        if !self.multiply_zeros(&mut numerator, self.ones) || !self.multiply_poles(&mut sum) {
            return Err(Unbuildable::OutOfRange);
        }
        numerator.scale(self.scale.mul(compliance));
        let degree = sum.degree();
        sum.add(&numerator);
        // The leading coefficient is 1 + compliance G(inf), times the denominator's.
        if self.denominator.is_zero() || sum.coefficient(degree).contains(0.0) {
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
        let (mut own, mut sum) = (self.numerator, self.denominator);
        if !self.multiply_zeros(&mut own, self.ones)
            || !self.multiply_poles(&mut sum)
            || !own.multiply(numerator)
            || !sum.multiply(denominator)
        {
            return Err(out_of_range);
        }
        let degree = sum.degree();
        own.scale(self.scale);
        sum.add(&own);
        if self.denominator.is_zero() || sum.coefficient(degree).contains(0.0) {
            return Err(Unbuildable::IllPosed);
        }
        let mut zeros = self.numerator;
        if !zeros.multiply(denominator) {
            return Err(out_of_range);
        }
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
        let mut sum = *self;
        if sum.add(other) { Some(sum) } else { None }
    }

    /// The same in place; `false` if the result has too high a degree. Not inlined, like the next functions:
    /// a small board's stack has no room for the polynomials of all of them.
    #[inline(never)]
    pub(crate) const fn add(&mut self, other: &Self) -> bool {
        let later = if self.shift > other.shift { self.shift } else { other.shift };
        if later < 0 {
            // Their common delay would raise the degree twice.
            self.shift -= later;
            let is_in_range = self.add(&Self { shift: other.shift - later, ..*other });
            self.shift += later;
            return is_in_range;
        }
        let ones = positive(if self.ones < other.ones { self.ones } else { other.ones });
        let mut numerator = self.numerator;
        let mut of_other = other.numerator;
        if !self.become_summand(&mut numerator, other, ones)
            || !other.become_summand(&mut of_other, self, ones)
        {
            return false;
        }
        numerator.add(&of_other);
        // Their memory is used twice.
        of_other = other.denominator;
        let mut denominator = self.denominator;
        if !self.multiply_poles(&mut denominator)
            || !other.multiply_poles(&mut of_other)
            || !denominator.multiply(&of_other)
        {
            return false;
        }
        let one = Interval::ONE;
        *self = Self { scale: one, shift: 0, ones, minus_ones: 0, numerator, denominator };
        true
    }

    /// Its numerator becomes its share of the numerator of a sum over the common denominator, without the
    /// common zeros at 1.
    #[inline(never)]
    const fn become_summand(&self, numerator: &mut Polynomial, other: &Self, ones: i32) -> bool {
        if !self.multiply_zeros(numerator, self.ones - ones) {
            return false;
        }
        let mut others = other.denominator;
        if !other.multiply_poles(&mut others) {
            return false;
        }
        numerator.scale(self.scale);
        numerator.multiply(&others)
    }

    /// Multiplies a polynomial by the zeros of the exponents, with these at 1.
    const fn multiply_zeros(&self, p: &mut Polynomial, ones: i32) -> bool {
        multiply_roots(p, self.shift, ones, self.minus_ones)
    }

    /// Multiplies a polynomial by the poles of the exponents.
    const fn multiply_poles(&self, p: &mut Polynomial) -> bool {
        multiply_roots(p, -self.shift, -self.ones, -self.minus_ones)
    }
}

const fn positive(value: i32) -> i32 {
    if value > 0 { value } else { 0 }
}

/// Multiplies by the roots at 0, 1 and -1 whose number is positive.
#[inline(never)]
const fn multiply_roots(p: &mut Polynomial, zero: i32, plus: i32, minus: i32) -> bool {
    p.shift_up(positive(zero) as usize)
        && p.multiply_by_unit_root(UnitRoot::Plus, positive(plus) as usize)
        && p.multiply_by_unit_root(UnitRoot::Minus, positive(minus) as usize)
}
